#include "core/borders/coverage_faults.h"

#include <algorithm>
#include <utility>

#include "core/borders/border_lengths.h"
#include "core/borders/regions.h"
#include "core/borders/set_map.h"
#include "core/grid/web_mercator.h"
#include "core/sweep/boundary_loops.h"

namespace trapeze {
namespace {

/// The surroundings of a region.
struct Surroundings {
  std::vector<Segment> segments;
  double border = 0;  // cells
  std::vector<std::uint32_t> beyond;
};

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
    place.segments.push_back(map_.borders().segments[e.value]);
    place.border += length_of(g_, g_.edge(e));
    if (!set_of(region).empty()) return;
    const auto& other = map_.sets()[g_.edge(e).face[beyond]];
    place.beyond.insert(place.beyond.end(), other.begin(), other.end());
  }

  CoverageFault fault_at(RegionId region, FaultKind kind,
                         const std::vector<std::uint32_t>& features) {
    const Surroundings& place = places_[region.value];
    const double metre = cells_from_ground(1, place.segments.front().first.y);
    CoverageFault fault;
    fault.kind = kind;
    fault.area = regions_.area[region] / (metre * metre);
    fault.width = regions_.area[region] / (place.border / 2) / metre;
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
