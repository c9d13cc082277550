#include "core/borders/coverage_groups.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "core/borders/box_ties.h"
#include "core/borders/merge_plan.h"
#include "core/grid/disjoint_sets.h"
#include "core/grid/ring_box.h"
#include "core/sweep/owned_segments.h"

namespace trapeze {
namespace {

/// The sets of two or more, in order of their first members.
std::vector<std::vector<std::uint32_t>> groups_of(DisjointSets& ties) {
  std::vector<std::vector<std::uint32_t>> by_first(ties.size());
  for (std::uint32_t i = 0; i < ties.size(); ++i) by_first[ties.find(i)].push_back(i);
  std::erase_if(by_first, [](const auto& group) { return group.size() < 2; });
  return by_first;
}

/// The box of a feature.
struct FeatureBox {
  Box box;
  std::uint32_t feature;
};

/// From west to east.
std::vector<FeatureBox> places_of(std::span<const Rings* const> features) {
  std::vector<FeatureBox> places;
  for (std::uint32_t i = 0; i < features.size(); ++i) {
    FeatureBox place{Box(), i};
    for (const Point p : features[i]->points) place.box.include(p);
    if (!place.box.is_empty()) places.push_back(place);
  }
  std::sort(places.begin(), places.end(), [](const FeatureBox& a, const FeatureBox& b) {
    return std::tuple(a.box.min_x, a.feature) < std::tuple(b.box.min_x, b.feature);
  });
  return places;
}

/// Calls visit(a, b) for every two places whose boxes intersect, for at most `most_steps` steps.
/// Returns whether all have been found.
template <typename Visit>
bool for_each_meeting(const std::vector<FeatureBox>& places, std::size_t most_steps,
                      const Visit& visit) {
  // A sweep from west to east over the boxes, keeping those not passed yet.
  std::vector<FeatureBox> open;
  std::size_t steps = 0;
  for (const FeatureBox& place : places) {
    steps += open.size();
    if (steps > most_steps) return false;
    std::erase_if(open, [&](const FeatureBox& other) { return other.box.max_x < place.box.min_x; });
    for (const FeatureBox& other : open) {
      if (other.box.intersects(place.box)) visit(other, place);
    }
    open.push_back(place);
  }
  return true;
}

/// By feature: the box around all intersections with the boxes of others; no segment beyond it can
/// be an edge of two features. Empty if there are none.
std::vector<Box> common_boxes(std::span<const Rings* const> features) {
  constexpr std::size_t kMostStepsOfEach = 1024;  // cheaper than sorting the segments
  std::vector<Box> common(features.size());
  const std::vector<FeatureBox> places = places_of(features);
  const bool are_all_found = for_each_meeting(
      places, kMostStepsOfEach * places.size(),
      [&common](const FeatureBox& a, const FeatureBox& b) {
        const Box both{std::max(a.box.min_x, b.box.min_x), std::max(a.box.min_y, b.box.min_y),
                       std::min(a.box.max_x, b.box.max_x), std::min(a.box.max_y, b.box.max_y)};
        common[a.feature].include(both);
        common[b.feature].include(both);
      });
  if (!are_all_found) {
    for (const FeatureBox& place : places) common[place.feature] = place.box;
  }
  return common;
}

void tie_by_edges(std::span<const Rings* const> features, unsigned threads, DisjointSets& ties) {
  const std::vector<Box> common = common_boxes(features);
  LargeArray<OwnedSegment> segments;
  for (std::uint32_t i = 0; i < features.size(); ++i) {
    if (!common[i].is_empty()) append_segments(*features[i], i, common[i], segments);
  }
  sort_by_place(segments, threads);
  for (std::size_t i = 1; i < segments.size(); ++i) {
    if (segments[i - 1].segment == segments[i].segment) {
      ties.tie(segments[i - 1].owner, segments[i].owner);
    }
  }
}

void tie_by_boxes(std::span<const Rings* const> features, DisjointSets& ties) {
  for_each_meeting(
      places_of(features), std::numeric_limits<std::size_t>::max(),
      [&ties](const FeatureBox& a, const FeatureBox& b) { ties.tie(a.feature, b.feature); });
}

/// The features without known group and those that may be tied to one of them, in ascending order;
/// all features if that is not known to be fewer.
std::vector<std::uint32_t> to_be_looked_at(std::span<const Rings* const> features,
                                           std::span<const std::uint32_t> known) {
  constexpr std::size_t kMostStepsOfEach = 64;  // cheaper than grouping
  std::vector<std::uint32_t> all(features.size());
  std::iota(all.begin(), all.end(), 0u);
  const auto unknown = static_cast<std::size_t>(std::ranges::count(known, kUnknownGroup));
  if (known.empty() || unknown > features.size() / 4) return all;

  const std::vector<FeatureBox> places = places_of(features);
  std::vector<FeatureBox> wanted;
  std::int64_t widest = 0;
  for (const FeatureBox& place : places) {
    if (known[place.feature] != kUnknownGroup) continue;
    wanted.push_back(place);
    widest = std::max(widest, std::int64_t{place.box.max_x} - place.box.min_x);
  }
  std::vector<std::uint32_t> found;
  std::size_t steps = 0;
  std::size_t first = 0;  // all before it end west of the place
  for (const FeatureBox& place : places) {
    while (first < wanted.size() && wanted[first].box.min_x + widest < place.box.min_x) ++first;
    bool is_near = known[place.feature] == kUnknownGroup;
    for (std::size_t i = first; !is_near && i < wanted.size(); ++i, ++steps) {
      if (wanted[i].box.min_x > place.box.max_x) break;
      is_near = wanted[i].box.intersects(place.box);
    }
    if (is_near) found.push_back(place.feature);
    if (steps > kMostStepsOfEach * features.size()) return all;
  }
  std::ranges::sort(found);
  return found;
}

void tie_known(std::span<const std::uint32_t> known, DisjointSets& ties) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> by_group;
  for (std::uint32_t i = 0; i < known.size(); ++i) {
    if (known[i] != kUnknownGroup) by_group.emplace_back(known[i], i);
  }
  std::ranges::sort(by_group);
  for (std::size_t i = 1; i < by_group.size(); ++i) {
    if (by_group[i - 1].first == by_group[i].first) {
      ties.tie(by_group[i - 1].second, by_group[i].second);
    }
  }
}

// The greatest overlap of two neighbours, as a fraction of the area of the smaller one.
constexpr double kMostOverlap = 0.01;

double most_overlap(CoverageMode coverage) {
  return coverage == CoverageMode::on ? std::numeric_limits<double>::infinity() : kMostOverlap;
}

// Half a metre at the equator, most of a pixel at zoom 18: slivers along borders that were
// digitized twice are narrower.
constexpr double kNarrowestOverlap = 32;

}  // namespace

std::vector<std::vector<std::uint32_t>> group_features(std::span<const Rings* const> features,
                                                       CoverageMode coverage, unsigned threads,
                                                       std::span<const std::uint32_t> known) {
  DisjointSets ties(features.size());
  const std::vector<std::uint32_t> open = to_be_looked_at(features, known);
  std::vector<const Rings*> rings;
  rings.reserve(open.size());
  for (const std::uint32_t i : open) rings.push_back(features[i]);
  DisjointSets found(open.size());
  if (coverage == CoverageMode::on) {
    tie_by_boxes(rings, found);
  } else {
    tie_by_edges(rings, threads, found);
  }
  for (const auto& group : groups_of(found)) {
    for (const std::uint32_t i : group) ties.tie(open[group.front()], open[i]);
  }
  tie_known(known, ties);
  return groups_of(ties);
}

std::vector<std::vector<std::uint32_t>> group_for_blocks(std::span<const Rings* const> features) {
  std::vector<Box> boxes;
  std::vector<std::uint32_t> owners;
  for (std::uint32_t i = 0; i < features.size(); ++i) {
    for (std::size_t r = 0; r < features[i]->size(); ++r) {
      const Box box = widened_for_blocks(box_of((*features[i])[r]));
      // A hole usually follows its shell.
      if (r > 0 && holds(boxes.back(), box)) continue;
      boxes.push_back(box);
      owners.push_back(i);
    }
  }
  DisjointSets ties(features.size());
  tie_meeting(boxes, owners, ties);
  std::vector<std::uint32_t> members(features.size());
  for (std::uint32_t i = 0; i < features.size(); ++i) ++members[ties.find(i)];
  std::optional<std::uint32_t> lonely;
  std::uint32_t lonely_ones = 0;
  for (std::uint32_t i = 0; i < features.size(); ++i) {
    if (members[ties.find(i)] > 1) continue;
    ++lonely_ones;
    if (!lonely) {
      lonely = i;
    } else {
      ties.tie(*lonely, i);
    }
  }
  if (lonely_ones == 1) ties.tie(*lonely, *lonely == 0 ? std::uint32_t(features.size() - 1) : 0);
  return groups_of(ties);
}

Assembly assemble(std::span<const Rings* const> features, CoverageMode coverage, double widest_gap,
                  CoverageBuilder& builder, TrapezoidalGraph& graph, WorkShare* share,
                  unsigned threads, const Merging& merging) {
  Assembly assembly;
  if (merging.ratio > 0) coverage = CoverageMode::on;
  const CoverageTolerance tolerance{most_overlap(coverage), kMostOverlap, widest_gap,
                                    kNarrowestOverlap};
  assembly.outcome = builder.build(features, tolerance, graph, share, threads, merging);
  const std::vector<std::uint32_t>& apart = assembly.outcome.apart;
  for (std::uint32_t i = 0; i < features.size(); ++i) {
    const bool is_apart =
        !assembly.outcome.built || std::binary_search(apart.begin(), apart.end(), i);
    (is_apart ? assembly.apart : assembly.together).push_back(i);
  }
  return assembly;
}

}  // namespace trapeze
