#include "core/borders/coverage_builder.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "core/borders/border_lengths.h"
#include "core/borders/dividing_edges.h"
#include "core/borders/merging.h"
#include "core/borders/regions.h"
#include "core/borders/set_map.h"
#include "core/grid/disjoint_sets.h"
#include "core/grid/web_mercator.h"

namespace trapeze {

namespace {

/// The features that begin and end at an edge of a subdivision by sets, in ascending order.
struct Crossing {
  std::vector<std::uint32_t> staying;  // on both of its sides
  std::vector<std::uint32_t> left;     // on its left side only
  std::vector<std::uint32_t> right;

  void assign(const std::vector<std::uint32_t>& left_set,
              const std::vector<std::uint32_t>& right_set) {
    staying.clear();
    left.clear();
    right.clear();
    std::ranges::set_intersection(left_set, right_set, std::back_inserter(staying));
    std::ranges::set_difference(left_set, right_set, std::back_inserter(left));
    std::ranges::set_difference(right_set, left_set, std::back_inserter(right));
  }

  /// The number of pairs of features that overlap on one of its sides and not on the other.
  std::size_t pairs() const {
    const auto on_side = [this](std::size_t n) { return n * staying.size() + n * (n - 1) / 2; };
    return (left.empty() ? 0 : on_side(left.size())) + (right.empty() ? 0 : on_side(right.size()));
  }
};

/// Sums up the areas of features, and of pairs of them, from the edges of a subdivision by sets:
/// the strip of an edge counts only for features on one side of it. Exact.
class OverlapAreas {
 public:
  explicit OverlapAreas(std::size_t features) : doubled_(features, 0) {}

  void add(const Crossing& crossing, Int128 doubled_strip) {
    add_side(crossing.left, crossing.staying, doubled_strip);
    add_side(crossing.right, crossing.staying, -doubled_strip);
  }

  /// For at most one feature on either side.
  void add(const std::vector<std::uint32_t>& left, const std::vector<std::uint32_t>& right,
           Int128 doubled_strip) {
    if (!left.empty()) doubled_[left.front()] += doubled_strip;
    if (!right.empty()) doubled_[right.front()] -= doubled_strip;
  }

  void store(CoverageOutcome& outcome) const {
    for (std::size_t i = 0; i < doubled_.size(); ++i) outcome.areas[i] = halved(doubled_[i]);
    for (const auto& [pair, doubled] : doubled_overlaps_) {
      if (doubled == 0) continue;  // side by side
      outcome.overlaps.push_back({static_cast<std::uint32_t>(pair >> 32),
                                  static_cast<std::uint32_t>(pair), halved(doubled)});
    }
    std::ranges::sort(outcome.overlaps, {}, [](const Overlap& overlap) {
      return std::pair(overlap.lower, overlap.upper);
    });
  }

 private:
  static double halved(Int128 doubled) { return static_cast<double>(doubled) / 2; }

  void add_side(const std::vector<std::uint32_t>& features,
                const std::vector<std::uint32_t>& staying, Int128 doubled_strip) {
    for (std::size_t i = 0; i < features.size(); ++i) {
      doubled_[features[i]] += doubled_strip;
      for (const std::uint32_t other : staying) add_pair(features[i], other, doubled_strip);
      for (std::size_t k = 0; k < i; ++k) add_pair(features[i], features[k], doubled_strip);
    }
  }

  void add_pair(std::uint32_t a, std::uint32_t b, Int128 doubled_strip) {
    doubled_overlaps_[std::uint64_t{std::min(a, b)} << 32 | std::max(a, b)] += doubled_strip;
  }

  std::vector<Int128> doubled_;
  std::unordered_map<std::uint64_t, Int128> doubled_overlaps_;
};

/// The areas and overlaps of the features of a subdivision. Returns false, with the reason as
/// failure, if more features overlap than can be counted in a second or two.
bool note_areas(const TrapezoidalGraph& g, const FeatureSets& sets, CoverageOutcome& outcome) {
  constexpr std::size_t kMostPairs = std::size_t{1} << 23;
  OverlapAreas areas(outcome.areas.size());
  Crossing crossing;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < g.edges().size(); ++i) {
    if (g.is_frame(EdgeId(i))) continue;
    const Edge& edge = g.edge(EdgeId(i));
    const std::vector<std::uint32_t>& left = sets[edge.face[kLeft]];
    const std::vector<std::uint32_t>& right = sets[edge.face[kRight]];
    if (left.size() <= 1 && right.size() <= 1) {
      if (left != right) areas.add(left, right, doubled_strip(g, edge));
      continue;
    }
    crossing.assign(left, right);
    pairs += crossing.pairs();
    if (pairs > kMostPairs) {
      outcome.failure = SetMap::kTooManyOverEachOther;
      return false;
    }
    areas.add(crossing, doubled_strip(g, edge));
  }
  areas.store(outcome);
  return true;
}

/// The number of edges that each feature shares with a neighbour on the other side.
std::vector<std::size_t> count_common_edges(const TrapezoidalGraph& g, const Borders& borders,
                                            const FeatureSets& sets, std::size_t features) {
  std::vector<std::size_t> count(features, 0);
  for (std::size_t e = 0; e < borders.segments.size(); ++e) {
    const std::vector<std::uint32_t>& owners = sets[borders.owners[e]];
    const std::vector<std::uint32_t>& left = sets[g.edge(EdgeId(e)).face[kLeft]];
    const auto ends_here = [&left](std::uint32_t owner) {
      return std::binary_search(left.begin(), left.end(), owner);
    };
    const auto ending = std::count_if(owners.begin(), owners.end(), ends_here);
    if (ending == 0 || ending == std::ssize(owners)) continue;
    for (const std::uint32_t owner : owners) ++count[owner];
  }
  return count;
}

/// The overlaps that exceed the fraction `most` of the area of the smaller feature; only those of
/// two of these features, in ascending order, unless there are none.
std::vector<Overlap> large_overlaps(const CoverageOutcome& outcome, double most,
                                    const std::vector<std::uint32_t>& only) {
  const auto is_meant = [&only](std::uint32_t feature) {
    return only.empty() || std::ranges::binary_search(only, feature);
  };
  std::vector<Overlap> overlaps;
  for (const Overlap& overlap : outcome.overlaps) {
    if (!is_meant(overlap.lower) || !is_meant(overlap.upper)) continue;
    const double smaller = std::min(outcome.areas[overlap.lower], outcome.areas[overlap.upper]);
    if (overlap.area > most * smaller) overlaps.push_back(overlap);
  }
  return overlaps;
}

/// Features without which no two overlap, in ascending order. Those that share the fewest edges
/// with neighbours are left out first: an overseas region that also occurs as a country, and not
/// the mainland. Ties go to the feature with the most overlaps, then to the last one.
std::vector<std::uint32_t> features_to_leave_out(const std::vector<Overlap>& overlaps,
                                                 const std::vector<std::size_t>& common_edges) {
  std::vector<std::vector<std::uint32_t>> overlapping(common_edges.size());
  for (const Overlap& overlap : overlaps) {
    overlapping[overlap.lower].push_back(overlap.upper);
    overlapping[overlap.upper].push_back(overlap.lower);
  }
  std::vector<std::size_t> count;  // number of overlaps with features not left out
  count.reserve(overlapping.size());
  for (const auto& others : overlapping) count.push_back(others.size());
  const auto goes_first = [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(common_edges[a], count[b], b) < std::tuple(common_edges[b], count[a], a);
  };
  std::set<std::uint32_t, decltype(goes_first)> waiting(goes_first);
  for (std::uint32_t i = 0; i < count.size(); ++i) {
    if (count[i] > 0) waiting.insert(i);
  }
  std::vector<std::uint32_t> apart;
  while (!waiting.empty()) {
    const std::uint32_t worst = *waiting.begin();
    waiting.erase(waiting.begin());
    apart.push_back(worst);
    for (const std::uint32_t other : overlapping[worst]) {
      // Its place in the order changes. Features left out before are no longer in it.
      if (waiting.erase(other) > 0 && --count[other] > 0) waiting.insert(other);
    }
  }
  std::sort(apart.begin(), apart.end());
  return apart;
}

/// Removes features, given in ascending order, from the findings for all features.
void leave_out(const std::vector<std::uint32_t>& features, CoverageOutcome& outcome) {
  const auto is_out = [&features](std::uint32_t feature) {
    return std::binary_search(features.begin(), features.end(), feature);
  };
  std::erase_if(outcome.overlaps, [&](const Overlap& overlap) {
    return is_out(overlap.lower) || is_out(overlap.upper);
  });
  for (const std::uint32_t feature : features) outcome.areas[feature] = 0;
  outcome.apart.insert(outcome.apart.end(), features.begin(), features.end());
  std::ranges::sort(outcome.apart);
}

/// Leaves features out until none, or none of `only`, overlap by more than that fraction of the
/// smaller one.
void leave_out_overlaps(const TrapezoidalGraph& g, const SetMap& map, double most,
                        const std::vector<std::uint32_t>& only, CoverageOutcome& outcome) {
  const std::vector<Overlap> overlaps = large_overlaps(outcome, most, only);
  if (overlaps.empty()) return;
  leave_out(features_to_leave_out(
                overlaps, count_common_edges(g, map.borders(), map.sets(), outcome.areas.size())),
            outcome);
}

/// The faces beside the edges of a subdivision by sets.
class SetFaces {
 public:
  /// The faces of the uppermost features, ignoring the features left out, which are in ascending
  /// order. The graph and the sets must outlive it.
  SetFaces(const TrapezoidalGraph& g, const FeatureSets& sets,
           const std::vector<std::uint32_t>& left_out)
      : g_(g), sets_(sets) {
    face_of_.reserve(sets.size());
    for (std::uint32_t i = 0; i < sets.size(); ++i) {
      face_of_.push_back(uppermost_of(sets[i], left_out));
    }
  }

  /// Gives wide places of several features faces of their own: one for all places of the same
  /// features. `left_out` is that of the constructor.
  void tell_apart(const std::vector<std::uint32_t>& left_out, double narrowest,
                  FaceFeatures& faces) {
    std::vector<std::vector<std::uint32_t>> covers = find_covers(left_out);
    if (covers.empty()) return;
    regions_.emplace(g_);
    DisjointSets places = joined_regions();
    const std::vector<bool> is_wide = find_wide(narrowest, places);
    std::vector<bool> has_face(covers.size(), false);
    for (std::size_t i = 0; i < is_wide.size(); ++i) {
      if (is_wide[i]) has_face[cover_of(RegionId(i))] = true;
    }
    std::vector<FaceId> face_of_cover(covers.size(), kOutside);
    for (std::size_t i = 0; i < covers.size(); ++i) {
      if (has_face[i]) face_of_cover[i] = faces.add(std::move(covers[i]));
    }
    shared_face_.reserve(is_wide.size());
    for (std::size_t i = 0; i < is_wide.size(); ++i) {
      const bool is_shared = is_wide[places.find(static_cast<std::uint32_t>(i))];
      shared_face_.push_back(is_shared ? face_of_cover[cover_of(RegionId(i))] : kOutside);
    }
  }

  FaceId beside(EdgeId e, Side s) const {
    if (shared_face_.size() > 0) {
      const FaceId shared = shared_face_[regions_->beside[e][s]];
      if (shared != kOutside) return shared;
    }
    return face_of_[g_.edge(e).face[s]];
  }
  /// Whether only features left out are there.
  bool has_only_left_out(EdgeId e, Side s) const {
    const FaceId set = g_.edge(e).face[s];
    return face_of_[set] == kOutside && !sets_[set].empty();
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  static FaceId uppermost_of(const std::vector<std::uint32_t>& set,
                             const std::vector<std::uint32_t>& left_out) {
    const auto uppermost =
        std::find_if(set.rbegin(), set.rend(), [&left_out](std::uint32_t feature) {
          return !std::ranges::binary_search(left_out, feature);
        });
    return uppermost == set.rend() ? kOutside : *uppermost + 1;
  }

  /// The sets of several features without those left out, and which of these each set is.
  std::vector<std::vector<std::uint32_t>> find_covers(const std::vector<std::uint32_t>& left_out) {
    std::vector<std::vector<std::uint32_t>> covers;
    std::map<std::vector<std::uint32_t>, std::uint32_t> numbers;
    cover_of_set_.assign(sets_.size(), kNone);
    for (std::uint32_t i = 0; i < sets_.size(); ++i) {
      if (sets_[i].size() < 2) continue;
      std::vector<std::uint32_t> set;
      std::ranges::set_difference(sets_[i], left_out, std::back_inserter(set));
      if (set.size() < 2) continue;
      const auto [known, is_new] = numbers.try_emplace(std::move(set), covers.size());
      cover_of_set_[i] = known->second;
      if (is_new) covers.push_back(known->first);
    }
    return covers;
  }

  std::uint32_t cover_of(RegionId region) const { return cover_of_set_[regions_->face[region]]; }

  template <typename Visit>
  void for_each_edge_between_regions(const Visit& visit) const {
    for (std::size_t i = 0; i < g_.edges().size(); ++i) {
      const EdgeId e(i);
      if (g_.is_frame(e)) continue;
      const auto [left, right] = regions_->beside[e];
      if (left != right) visit(g_.edge(e), left, right);
    }
  }

  /// The regions, joined where adjacent ones have the same cover: only features left out end there.
  DisjointSets joined_regions() const {
    DisjointSets places(regions_->face.size());
    for_each_edge_between_regions([&](const Edge&, RegionId left, RegionId right) {
      const bool is_shared = cover_of(left) != kNone;
      if (is_shared && cover_of(left) == cover_of(right)) places.tie(left.value, right.value);
    });
    return places;
  }

  /// By the first region of a place with a cover: whether its mean width is greater than that.
  std::vector<bool> find_wide(double narrowest, DisjointSets& places) const {
    struct Extent {
      double area = 0;    // cells squared
      double border = 0;  // its length
    };
    std::vector<Extent> extents(places.size());
    for_each_edge_between_regions([&](const Edge& edge, RegionId left, RegionId right) {
      if (places.find(left.value) == places.find(right.value)) return;
      const bool is_left = cover_of(left) != kNone;
      const bool is_right = cover_of(right) != kNone;
      if (!is_left && !is_right) return;
      const double strip = static_cast<double>(doubled_strip(g_, edge)) / 2;
      const double length = length_of(g_, edge);
      const auto add = [&](RegionId region, double area) {
        Extent& extent = extents[places.find(region.value)];
        extent.area += area;
        extent.border += length;
      };
      if (is_left) add(left, strip);
      if (is_right) add(right, -strip);
    });
    std::vector<bool> is_wide;
    is_wide.reserve(extents.size());
    for (const Extent& extent : extents) {
      is_wide.push_back(extent.border > 0 && 2 * extent.area / extent.border > narrowest);
    }
    return is_wide;
  }

  const TrapezoidalGraph& g_;
  const FeatureSets& sets_;
  std::vector<FaceId> face_of_;              // by set
  std::vector<std::uint32_t> cover_of_set_;  // kNone: at most one feature
  std::optional<Regions> regions_;           // if any place has several features
  Table<RegionId, FaceId> shared_face_;      // of wide places; kOutside elsewhere
};

bool is_deep(const std::vector<std::uint32_t>& place) {
  constexpr std::size_t kMostAtAPlace = 64;
  return place.size() > kMostAtAPlace;
}

/// The features of all places that too many cover, in ascending order.
std::vector<std::uint32_t> features_of_deep_places(const FaceFeatures& faces) {
  std::vector<std::uint32_t> features;
  for (const std::vector<std::uint32_t>& place : faces.shared()) {
    if (is_deep(place)) features.insert(features.end(), place.begin(), place.end());
  }
  std::ranges::sort(features);
  const auto repeated = std::unique(features.begin(), features.end());
  features.erase(repeated, features.end());
  return features;
}

/// Whether so many features overlap that a graph with trapezoids for each of them would be much
/// larger than those of single features, which have that many vertices.
bool is_crowded(const TrapezoidalGraph& g, const SetFaces& faces, const FaceFeatures& features,
                std::size_t vertices) {
  constexpr std::size_t kAlways = 4096;
  constexpr std::size_t kMostPerVertex = 16;
  if (std::ranges::any_of(features.shared(), is_deep)) return true;
  if (features.shared().empty()) return false;
  std::size_t sides = 0;  // about as many as trapezoids
  for (std::size_t i = 0; i < g.edges().size(); ++i) {
    if (g.is_frame(EdgeId(i))) continue;
    const FaceId left = faces.beside(EdgeId(i), kLeft);
    const FaceId right = faces.beside(EdgeId(i), kRight);
    if (left != right) sides += features.of(left).size() + features.of(right).size();
  }
  return sides > kAlways + kMostPerVertex * vertices;
}

/// The number of vertices of the features that are not left out.
std::size_t count_vertices(std::span<const Rings* const> features,
                           const std::vector<std::uint32_t>& left_out) {
  std::size_t vertices = 0;
  for (std::uint32_t i = 0; i < features.size(); ++i) {
    if (!std::ranges::binary_search(left_out, i)) vertices += features[i]->points.size();
  }
  return vertices;
}

/// The faces of those features that can share a graph; others are left out. None if fewer than that
/// many remain, or if they form a crowd. If it is enough, only features of the places that too many
/// cover are left out as a crowd: a group may be a whole town.
std::optional<SetFaces> choose_faces(const TrapezoidalGraph& g, const SetMap& map,
                                     std::span<const Rings* const> features,
                                     const CoverageTolerance& tolerance, std::size_t least,
                                     CoverageOutcome& outcome) {
  std::vector<std::uint32_t> only;
  for (const double most :
       {tolerance.most_overlap, tolerance.most_overlap_in_crowd, tolerance.most_overlap_in_crowd}) {
    leave_out_overlaps(g, map, most, only, outcome);
    if (features.size() < outcome.apart.size() + least) return std::nullopt;
    outcome.faces = FaceFeatures::in_order(features.size());
    SetFaces faces(g, map.sets(), outcome.apart);
    if (std::isfinite(tolerance.narrowest_overlap)) {
      faces.tell_apart(outcome.apart, tolerance.narrowest_overlap, outcome.faces);
    }
    const std::size_t vertices = count_vertices(features, outcome.apart);
    if (!is_crowded(g, faces, outcome.faces, vertices)) return faces;
    only.clear();
    if (!std::exchange(outcome.is_crowded, true)) only = features_of_deep_places(outcome.faces);
  }
  outcome.failure = SetMap::kTooManyOverEachOther;
  return std::nullopt;
}

/// Places that only features left out cover get the face `left_out`, which may be kOutside.
Sides sides_of(const SetFaces& faces, FaceId left_out, std::size_t edges) {
  const auto face_beside = [&](EdgeId e, Side s) {
    return faces.has_only_left_out(e, s) ? left_out : faces.beside(e, s);
  };
  Sides sides;
  sides.reserve(edges);
  for (std::size_t i = 0; i < edges; ++i) {
    const EdgeId e(i);
    sides.emplace_back(face_beside(e, kLeft), face_beside(e, kRight));
  }
  return sides;
}

/// The features around a region that no feature covers.
struct Gap {
  double border = 0;  // its length in cells
  double reach = 0;   // the widest gap at this place, in cells
  BorderLengths neighbours = {};
};

/// Gives narrow gaps between features the face of a neighbour; returns the number of such gaps.
/// `left_out` is the face of features left out: their places are no gaps, and become kOutside.
std::size_t fill_gaps(const TrapezoidalGraph& g, double widest_gap, const FaceFeatures& faces,
                      FaceId left_out, Sides& sides) {
  const Regions regions(g);
  std::vector<Gap> gaps(regions.face.size());
  const auto hole_beside = [&](std::size_t e, Side s) {
    const RegionId region = regions.beside[EdgeId(e)][s];
    return regions.face[region] == kOutside && region != regions.unbounded ? region : RegionId();
  };
  // Beside a place of several features, a gap goes to the uppermost: no overlap becomes larger.
  const auto neighbour = [&faces](FaceId face) {
    const auto features = faces.of(face);
    return features.size() < 2 ? face : features.back() + 1;
  };
  for (std::size_t e = 0; e < sides.size(); ++e) {
    for (const Side s : {kLeft, kRight}) {
      const RegionId hole = hole_beside(e, s);
      if (hole.is_none()) continue;
      const Edge& edge = g.edge(EdgeId(e));
      const double length = length_of(g, edge);
      Gap& gap = gaps[hole.value];
      gap.reach = cells_from_ground(widest_gap, g.point(edge.end[kUp]).y);
      gap.border += length;
      const FaceId beyond = s == kLeft ? sides[e].second : sides[e].first;
      if (beyond != left_out) gap.neighbours.add(neighbour(beyond), length);
    }
  }
  const auto is_narrow = [&](RegionId hole) {
    const Gap& gap = gaps[hole.value];
    return gap.neighbours.faces() > 1 &&
           regions.area[hole] <=
               gap.reach * std::min(gap.border / 2, gap.neighbours.greatest_length());
  };
  for (std::size_t e = 0; e < sides.size(); ++e) {
    for (const Side s : {kLeft, kRight}) {
      const RegionId hole = hole_beside(e, s);
      if (hole.is_none() || !is_narrow(hole)) continue;
      (s == kLeft ? sides[e].first : sides[e].second) = gaps[hole.value].neighbours.longest();
    }
  }
  for (auto& [left, right] : sides) {
    if (left == left_out) left = kOutside;
    if (right == left_out) right = kOutside;
  }
  std::size_t filled = 0;
  for (std::size_t r = 0; r < gaps.size(); ++r) filled += is_narrow(RegionId(r));
  return filled;
}

/// Whether there are features on both sides, and different ones.
bool parts_features(const FaceFeatures& faces, const Edge& edge) {
  const auto left = faces.of(edge.face[kLeft]);
  const auto right = faces.of(edge.face[kRight]);
  return !left.empty() && !right.empty() &&
         std::ranges::none_of(left, [right](std::uint32_t feature) {
           return std::ranges::binary_search(right, feature);
         });
}

void count_borders(const TrapezoidalGraph& g, const Regions& regions, CoverageOutcome& outcome) {
  outcome.vertices = g.vertex_count();
  std::vector<FaceId> first_beside(regions.face.size(), kOutside);
  std::vector<bool> is_gap(regions.face.size(), false);
  for (std::size_t i = 0; i < g.edges().size(); ++i) {
    const Edge& edge = g.edge(EdgeId(i));
    if (!edge.is_alive() || g.is_frame(EdgeId(i))) continue;
    outcome.shared_edges += parts_features(outcome.faces, edge);
    for (const Side s : {kLeft, kRight}) {
      if (edge.face[s] != kOutside) continue;
      const RegionId hole = regions.beside[EdgeId(i)][s];
      FaceId& first = first_beside[hole.value];
      if (first == kOutside) first = edge.face[opposite(s)];
      if (first != edge.face[opposite(s)] && hole != regions.unbounded) is_gap[hole.value] = true;
    }
  }
  outcome.gaps = static_cast<std::size_t>(std::count(is_gap.begin(), is_gap.end(), true));
}

/// The vertex of every end of an arc, in ascending order.
std::vector<VertexId> ends_of_arcs(const TrapezoidalGraph& g) {
  std::vector<VertexId> ends;
  for (const Corner& corner : g.corners()) {
    if (corner.is_end()) ends.push_back(corner.vertex);
  }
  std::sort(ends.begin(), ends.end());
  return ends;
}

std::size_t count_distinct(const std::vector<VertexId>& sorted) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) count += i == 0 || sorted[i - 1] != sorted[i];
  return count;
}

/// Whenever a region disappears, all arcs that end at its junctions are examined: the squares of
/// their numbers must not add up to more than a fraction of a second's work. Returns the reason if
/// they do, or an empty string.
std::string crowd_at_a_junction(const std::vector<VertexId>& ends, std::size_t edges) {
  constexpr std::size_t kAlways = std::size_t{1} << 24;  // 4,096 at one vertex
  constexpr std::size_t kMostPerEdge = 256;
  std::size_t squares = 0;
  std::size_t most = 0;
  for (std::size_t i = 0; i < ends.size();) {
    const std::size_t begin = i;
    while (i < ends.size() && ends[i] == ends[begin]) ++i;
    squares += (i - begin) * (i - begin);
    most = std::max(most, i - begin);
  }
  if (squares <= kAlways + kMostPerEdge * edges) return {};
  return "up to " + std::to_string(most) + " borders meet at one vertex";
}

}  // namespace

Overlay overlay(std::span<const Rings* const> features) {
  CoverageOutcome outcome;
  outcome.areas.assign(features.size(), 0);
  SetMap map(features);
  Boundary boundary;
  Trapezoidation trapezoidation;
  TrapezoidalGraph graph;
  if (map.sweep(boundary, trapezoidation, graph)) note_areas(graph, map.sets(), outcome);
  if (outcome.failure.empty()) outcome.failure = map.failure();
  return {std::move(outcome.overlaps), std::move(outcome.areas), std::move(outcome.failure)};
}

CoverageOutcome CoverageBuilder::build(std::span<const Rings* const> features,
                                       const CoverageTolerance& tolerance, TrapezoidalGraph& graph,
                                       WorkShare* share, unsigned threads, const Merging& merging) {
  const auto tell = [share](double part) {
    if (share != nullptr) share->tell(part);
  };
  CoverageOutcome outcome;
  SetMap map(features, threads);
  const bool is_swept = map.sweep(boundary_, trapezoidation_, graph);
  outcome.noded = map.is_noded();
  outcome.failure = map.failure();
  if (!is_swept) return outcome;
  tell(0.5);
  outcome.areas.assign(features.size(), 0);
  if (!note_areas(graph, map.sets(), outcome)) return outcome;
  const std::size_t least = merging.ratio > 0 && features.size() == 1 ? 1 : 2;
  const std::optional<SetFaces> faces =
      choose_faces(graph, map, features, tolerance, least, outcome);
  if (!faces) return outcome;
  tell(0.6);
  const bool fills_gaps = tolerance.widest_gap > 0;
  const FaceId left_out =
      fills_gaps ? static_cast<FaceId>(outcome.faces.face_count() + 1) : kOutside;
  Sides sides = sides_of(*faces, left_out, boundary_.edges.size());
  if (!keep_what_divides(sides, boundary_, trapezoidation_, graph, threads)) return outcome;
  if (fills_gaps) {
    outcome.filled = fill_gaps(graph, tolerance.widest_gap, outcome.faces, left_out, sides);
    if (!keep_what_divides(sides, boundary_, trapezoidation_, graph, threads)) return outcome;
  }
  tell(0.8);
  const Regions regions(graph);
  arcs_.trace(boundary_, static_cast<FaceId>(outcome.faces.face_count()), regions, graph);
  const std::vector<VertexId> ends = ends_of_arcs(graph);
  outcome.failure = crowd_at_a_junction(ends, graph.edges().size());
  if (!outcome.failure.empty()) return outcome;
  outcome.built = true;
  outcome.junctions = count_distinct(ends);
  count_borders(graph, regions, outcome);
  if (merging.ratio > 0) plan_blocks(merging, graph, threads, outcome);
  return outcome;
}

/// For a coverage that has been built except for blocks.
void CoverageBuilder::plan_blocks(const Merging& merging, TrapezoidalGraph& graph, unsigned threads,
                                  CoverageOutcome& outcome) {
  const auto first_void = static_cast<FaceId>(outcome.faces.face_count() + 1);
  std::optional<DividedVoid> divided =
      divide_void(graph, merging.ratio, first_void, classes_of_faces(outcome.faces, merging));
  if (!divided) return;
  outcome.plan = std::move(divided->plan);
  if (divided->segments.empty()) return;
  boundary_.assign(divided->segments);
  const FaceBeyond given = [&](EdgeId e, FaceId) { return divided->sides[e.value].second; };
  [[maybe_unused]] const bool is_swept = trapezoidation_.build(boundary_, given, graph, threads);
  assert(is_swept);  // new edges lie within the void and meet at their ends only
  outcome.faces.add_void(outcome.plan->due.size());
  arcs_.trace(boundary_, static_cast<FaceId>(outcome.faces.face_count()), Regions(graph), graph);
}

namespace {

/// An end of an arc of the boundary of a feature.
struct ArcEnd {
  std::uint32_t feature;
  VertexId vertex;
  CornerId corner;  // the first or the last one of the arc
  CornerId other;   // at the other end
  auto operator<=>(const ArcEnd&) const = default;
};

/// Arranges the boundary of each feature into closed rings.
class FeatureRings {
 public:
  FeatureRings(const TrapezoidalGraph& graph, const FaceFeatures& faces, std::size_t features)
      : g_(graph), faces_(faces), rings_(features), seen_(graph.corners().size(), false) {
    for (const bool is_loop : {false, true}) {
      for (std::size_t i = 0; i < g_.corners().size(); ++i) {
        const CornerId c(i);
        const Corner& corner = g_.corner(c);
        if (!corner.is_alive() || seen_[i] || (!is_loop && !corner.prev.is_none())) continue;
        add(c, is_loop);
      }
    }
    std::sort(ends_.begin(), ends_.end());
    is_used_.assign(ends_.size(), false);
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      if (!is_used_[i]) walk(i);
    }
  }

  std::vector<Rings> take() { return std::move(rings_); }

 private:
  /// Adds an arc from its first corner, or a loop.
  void add(CornerId first, bool is_loop) {
    CornerId last = first;
    seen_[first.value] = true;
    for (CornerId c = g_.corner(first).next; !c.is_none() && c != first; c = g_.corner(c).next) {
      seen_[c.value] = true;
      last = c;
    }
    const auto add_to = [&](std::uint32_t feature) {
      if (is_loop) {
        append(first, last, rings_[feature]);
        rings_[feature].points.push_back(g_.point(g_.corner(last).vertex));
        rings_[feature].close_ring();
      } else {
        ends_.push_back({feature, g_.corner(first).vertex, first, last});
        ends_.push_back({feature, g_.corner(last).vertex, last, first});
      }
    };
    const Edge& edge = g_.edge(g_.corner(first).edge);
    const auto left = faces_.of(edge.face[kLeft]);
    const auto right = faces_.of(edge.face[kRight]);
    for_each_apart(left, right, add_to);
    for_each_apart(right, left, add_to);
  }

  /// Walks from arc to arc until the ring is back where it began.
  void walk(std::size_t start) {
    Rings& rings = rings_[ends_[start].feature];
    std::size_t at = start;
    do {
      const ArcEnd& end = ends_[at];
      append(end.corner, end.other, rings);
      is_used_[at] = true;
      const ArcEnd arrived{end.feature, g_.corner(end.other).vertex, end.other, end.corner};
      const auto found = std::lower_bound(ends_.begin(), ends_.end(), arrived);
      is_used_[static_cast<std::size_t>(found - ends_.begin())] = true;
      at = next_of(arrived, start);
    } while (at != start);
    rings.close_ring();
  }

  /// Where a ring that arrived at a vertex continues: at the next end around the vertex, across the
  /// inside of the feature. So rings touch themselves and each other, but do not cross. At each
  /// vertex a feature has an even number of ends of arcs, so there is one until the ring is closed.
  std::size_t next_of(const ArcEnd& arrived, std::size_t start) const {
    const auto first =
        std::lower_bound(ends_.begin(), ends_.end(),
                         ArcEnd{arrived.feature, arrived.vertex, CornerId(0), CornerId(0)});
    auto i = static_cast<std::size_t>(first - ends_.begin());
    std::optional<std::size_t> next;
    for (; i < ends_.size() && ends_[i].feature == arrived.feature &&
           ends_[i].vertex == arrived.vertex;
         ++i) {
      if (is_used_[i] && i != start) continue;
      if (!next || is_before(ends_[i], ends_[*next], arrived)) next = i;
    }
    return next.value_or(start);
  }

  /// Whether the first of two ends at a vertex comes before the second one on the way around it
  /// from the arc that arrived there, across the inside beside that arc.
  bool is_before(const ArcEnd& one, const ArcEnd& other, const ArcEnd& arrived) const {
    const Edge& edge = edge_at(arrived);
    const auto on_the_left = faces_.of(edge.face[kLeft]);
    const bool is_left = std::ranges::find(on_the_left, arrived.feature) != on_the_left.end();
    // As seen from the vertex, the left of an edge that leads down is on the right.
    const bool turns_right = is_left == (edge.end[kUp] == arrived.vertex);
    const Point vertex = g_.point(arrived.vertex);
    const Point from = point_beyond(arrived);
    const auto is_farther = [&](Point a, Point b) {
      const std::int64_t turn = orientation(vertex, a, b);
      return turns_right ? turn > 0 : turn < 0;
    };
    const auto is_in_first_half = [&](Point p) { return is_farther(from, p); };
    const Point a = point_beyond(one);
    const Point b = point_beyond(other);
    if (is_in_first_half(a) != is_in_first_half(b)) return is_in_first_half(a);
    return is_farther(a, b);
  }

  const Edge& edge_at(const ArcEnd& end) const {
    const Corner& corner = g_.corner(end.corner);
    return g_.edge(corner.next.is_none() ? g_.corner(corner.prev).edge : corner.edge);
  }

  /// The other end of the edge at the end of an arc.
  Point point_beyond(const ArcEnd& end) const {
    const Edge& edge = edge_at(end);
    return g_.point(edge.end[edge.end[kUp] == end.vertex ? kDown : kUp]);
  }

  /// The points of an arc between its ends, including the end at which it begins.
  void append(CornerId from, CornerId to, Rings& rings) const {
    const bool is_forward = !g_.corner(from).next.is_none();
    for (CornerId c = from; c != to; c = is_forward ? g_.corner(c).next : g_.corner(c).prev) {
      rings.points.push_back(g_.point(g_.corner(c).vertex));
    }
  }

  const TrapezoidalGraph& g_;
  const FaceFeatures& faces_;
  std::vector<Rings> rings_;
  std::vector<bool> seen_;
  std::vector<ArcEnd> ends_;
  std::vector<bool> is_used_;
};

}  // namespace

std::vector<Rings> rings_of_faces(const TrapezoidalGraph& graph) {
  const std::size_t faces = graph.face_count();
  return FeatureRings(graph, FaceFeatures::in_order(faces), faces).take();
}

std::vector<Rings> rings_of_features(const TrapezoidalGraph& graph, const FaceFeatures& faces) {
  return FeatureRings(graph, faces, faces.single_count()).take();
}

}  // namespace trapeze
