// Groups the polygons of a layer that belong in one graph because they share borders.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/borders/coverage_builder.h"
#include "core/borders/coverage_options.h"
#include "core/grid/rings.h"

namespace trapeze {

/// The group of a feature is not known.
constexpr std::uint32_t kUnknownGroup = 0xffffffff;

/// Groups of two or more features, each feature by its position in `features`, in ascending order;
/// the groups are in order of their first features. With `automatic`, two features are in the same
/// group if they share an edge; with `on`, if their boxes intersect. Preconditions: `coverage` is
/// not `off`, and rings are clean (see clean_rings.h). Runs on up to `threads` threads.
///
/// `known`, by feature or empty, speeds this up with the result of an earlier grouping: features of
/// the same number are in the same group whatever the others are, and two of different numbers
/// share no edge, or their boxes do not intersect. The groups are the same without it.
std::vector<std::vector<std::uint32_t>> group_features(std::span<const Rings* const> features,
                                                       CoverageMode coverage, unsigned threads = 1,
                                                       std::span<const std::uint32_t> known = {});

/// Groups features, as above, so that features of two groups never become one block (see
/// merging.h): they are farther apart than kWidestBridge. Features that are near no other form one
/// group, so that their courtyards are filled as well. No group has a single feature if there are
/// several features.
std::vector<std::vector<std::uint32_t>> group_for_blocks(std::span<const Rings* const> features);

/// A group, split into the features that share a graph and those that do not. By position, in
/// ascending order.
struct Assembly {
  std::vector<std::uint32_t> together;  // in one graph
  std::vector<std::uint32_t> apart;     // each to be built separately
  CoverageOutcome outcome;              // of those together; built if there are any; its faces are
                                        // those of the graph
};

/// Makes `graph` the graph of the features of a group that can share one (see CoverageBuilder).
/// Features that overlap too much stay apart, and so do all if fewer than two remain or if they
/// cannot be noded. With `on`, only features of a crowd overlap too much. Gaps of up to
/// `widest_gap` metres are filled. Nearby features become blocks according to `merging`; features
/// may then overlap, as with `on`. Reports progress to `share`, if given. Runs on up to `threads`
/// threads; the result does not depend on their number.
Assembly assemble(std::span<const Rings* const> features, CoverageMode coverage, double widest_gap,
                  CoverageBuilder& builder, TrapezoidalGraph& graph, WorkShare* share = nullptr,
                  unsigned threads = 1, const Merging& merging = {});

}  // namespace trapeze
