#include "core/borders/coverage_faults.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/borders/border_lengths.h"
#include "core/borders/regions.h"
#include "core/borders/set_map.h"
#include "core/grid/web_mercator.h"
#include "core/sweep/graph_builder.h"

namespace trapeze {
namespace {

/// Joins the edges around a place to rings: at every vertex there is an even number of their ends.
Rings rings_around(const TrapezoidalGraph& g, const std::vector<EdgeId>& edges) {
  const auto later = [](Point a, Point b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); };
  std::map<Point, std::vector<std::size_t>, decltype(later)> edges_at(later);
  const auto point_at = [&](std::size_t i, Direction end) {
    return g.point(g.edge(edges[i]).end[end]);
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (const Direction end : {kUp, kDown}) edges_at[point_at(i, end)].push_back(i);
  }
  std::vector<bool> is_used(edges.size(), false);
  // The next edge that is not used, or the number of edges.
  const auto next_at = [&](Point place) {
    std::vector<std::size_t>& waiting = edges_at[place];
    while (!waiting.empty() && is_used[waiting.back()]) waiting.pop_back();
    return waiting.empty() ? edges.size() : waiting.back();
  };
  Rings rings;
  for (std::size_t first = 0; first < edges.size(); ++first) {
    if (is_used[first]) continue;
    Point here = point_at(first, kUp);
    for (std::size_t i = next_at(here); i < edges.size(); i = next_at(here)) {
      is_used[i] = true;
      rings.points.push_back(here);
      here = point_at(i, kUp) == here ? point_at(i, kDown) : point_at(i, kUp);
    }
    rings.close_ring();
  }
  return rings;
}

/// What lies around a region.
struct Place {
  std::vector<EdgeId> edges;
  double border = 0;  // cells
  std::vector<std::uint32_t> beyond;
};

class FaultSearch {
 public:
  FaultSearch(const TrapezoidalGraph& graph, const FeatureSets& sets)
      : g_(graph), sets_(sets), regions_(graph), places_(regions_.face.size()) {
    for (std::size_t i = 0; i < g_.edges().size(); ++i) {
      const EdgeId e(i);
      if (g_.is_frame(e)) continue;
      for (const Side s : {kLeft, kRight}) add_edge(e, regions_.beside[e][s], opposite(s));
    }
  }

  std::vector<CoverageFault> find() {
    std::vector<CoverageFault> faults;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      Place& place = places_[i];
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
    return sets_[regions_.face[region]];
  }

  /// Notes what the edge tells of a region at its side, if that may be a fault.
  void add_edge(EdgeId e, RegionId region, Side beyond) {
    if (region == regions_.unbounded || set_of(region).size() == 1) return;
    Place& place = places_[region.value];
    place.edges.push_back(e);
    place.border += length_of(g_, g_.edge(e));
    if (!set_of(region).empty()) return;
    const auto& other = sets_[g_.edge(e).face[beyond]];
    place.beyond.insert(place.beyond.end(), other.begin(), other.end());
  }

  CoverageFault fault_at(RegionId region, FaultKind kind,
                         const std::vector<std::uint32_t>& features) {
    const Place& place = places_[region.value];
    Rings rings = rings_around(g_, place.edges);
    const double metre = cells_from_ground(1, rings.points.front().y);
    CoverageFault fault;
    fault.kind = kind;
    fault.area = regions_.area[region] / (metre * metre);
    fault.width = regions_.area[region] / (place.border / 2) / metre;
    fault.features = features;
    if (builder_.build(rings, alone_).built) fault.polygons = polygons_of(alone_);
    return fault;
  }

  const TrapezoidalGraph& g_;
  const FeatureSets& sets_;
  const Regions regions_;
  std::vector<Place> places_;
  GraphBuilder builder_;
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
    found.faults = FaultSearch(graph, map.sets()).find();
  }
  found.failure = map.failure();
  return found;
}

}  // namespace trapeze
