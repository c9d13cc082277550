#include "core/borders/coverage_faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/borders/regions.h"
#include "core/borders/set_map.h"
#include "core/grid/web_mercator.h"
#include "core/sweep/boundary_loops.h"

namespace trapeze {
namespace {

/// The surroundings of a region.
struct Surroundings {
  std::vector<Segment> segments;
  double x = 0;       // of the meridian from which the area is counted
  double area = 0;    // square metres on the ground
  double border = 0;  // metres on the ground
  std::vector<std::uint32_t> beyond;
};

/// Of an edge: the area between it and a meridian, negative to the west of it, and its length.
struct OnGround {
  double area = 0;    // square metres
  double length = 0;  // metres
};

OnGround on_ground(const Segment& edge, double meridian) {
  // The scale of the map changes with latitude: Gauss-Legendre on pieces that are short enough for
  // the precision of a double.
  struct Node {
    double at;
    double weight;
  };
  constexpr std::array<Node, 3> kNodes = {
      {{0.11270166537925831, 5.0 / 18}, {0.5, 8.0 / 18}, {0.88729833462074169, 5.0 / 18}}};
  constexpr double kPiece = 1 << 22;  // cells: 80 kilometres at the equator
  const auto [from, to] = edge;
  const double dx = static_cast<double>(to.x) - from.x;
  const double dy = static_cast<double>(to.y) - from.y;
  const double length = std::hypot(dx, dy);
  const double pieces = 1 + std::floor(std::abs(dy) / kPiece);
  OnGround sum;
  for (double piece = 0; piece < pieces; ++piece) {
    for (const auto [at, weight] : kNodes) {
      const double along = (piece + at) / pieces;
      const double metre = cells_from_ground(1, from.y + along * dy);
      sum.area += weight / pieces * (from.x + along * dx - meridian) * dy / (metre * metre);
      sum.length += weight / pieces * length / metre;
    }
  }
  return sum;
}

class FaultSearch {
 public:
  /// `graph` is the subdivision of the map.
  FaultSearch(const TrapezoidalGraph& graph, const SetMap& map)
      : g_(graph), map_(map), regions_(graph), places_(regions_.face.size()) {
    for (std::size_t i = 0; i < g_.edges().size(); ++i) {
      const EdgeId e(i);
      if (g_.is_frame(e)) continue;
      for (const Side s : {kLeft, kRight}) add_edge(e, regions_.beside[e][s], opposite(s));
    }
  }

  std::vector<CoverageFault> find() {
    std::vector<CoverageFault> faults;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      Surroundings& place = places_[i];
      std::ranges::sort(place.beyond);
      place.beyond.erase(std::unique(place.beyond.begin(), place.beyond.end()), place.beyond.end());
      if (const auto& over = set_of(RegionId(i)); over.size() > 1) {
        faults.push_back(fault_at(RegionId(i), FaultKind::overlap, over));
      } else if (over.empty() && place.beyond.size() > 1) {
        faults.push_back(fault_at(RegionId(i), FaultKind::gap, place.beyond));
      }
    }
    return faults;
  }

 private:
  const std::vector<std::uint32_t>& set_of(RegionId region) const {
    return map_.sets()[regions_.face[region]];
  }

  /// Records the edge for the region at its side, if that may be a fault.
  void add_edge(EdgeId e, RegionId region, Side beyond) {
    if (region == regions_.unbounded || set_of(region).size() == 1) return;
    Surroundings& place = places_[region.value];
    const Edge& edge = g_.edge(e);
    const Segment segment{g_.point(edge.end[kUp]), g_.point(edge.end[kDown])};
    if (place.segments.empty()) place.x = segment.first.x;
    const OnGround strip = on_ground(segment, place.x);
    place.area += beyond == kRight ? strip.area : -strip.area;
    place.border += strip.length;
    place.segments.push_back(map_.borders().segments[e.value]);
    if (!set_of(region).empty()) return;
    const auto& other = map_.sets()[g_.edge(e).face[beyond]];
    place.beyond.insert(place.beyond.end(), other.begin(), other.end());
  }

  CoverageFault fault_at(RegionId region, FaultKind kind,
                         const std::vector<std::uint32_t>& features) {
    const Surroundings& place = places_[region.value];
    CoverageFault fault;
    fault.kind = kind;
    fault.area = place.area;
    fault.width = place.area / (place.border / 2);
    fault.features = features;
    boundary_.assign(place.segments);
    trapezoidation_.build(boundary_, alone_);  // a part of a noded map is noded
    loops_.trace(boundary_, alone_);
    fault.polygons = polygons_of(alone_);
    return fault;
  }

  const TrapezoidalGraph& g_;
  const SetMap& map_;
  const Regions regions_;
  std::vector<Surroundings> places_;
  Boundary boundary_;
  Trapezoidation trapezoidation_;
  BoundaryLoops loops_;
  TrapezoidalGraph alone_;
};

}  // namespace

CoverageFaults find_faults(std::span<const Rings* const> features) {
  SetMap map(features);
  Boundary boundary;
  Trapezoidation trapezoidation;
  TrapezoidalGraph graph;
  CoverageFaults found;
  if (map.sweep(boundary, trapezoidation, graph)) {
    found.faults = FaultSearch(graph, map).find();
  }
  found.failure = map.failure();
  return found;
}

}  // namespace trapeze
