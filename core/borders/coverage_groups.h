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

/// Nothing is known of the group of a feature.
constexpr std::uint32_t kUnknownGroup = 0xffffffff;

/// Groups of two or more features, each feature by its position in `features`, in ascending order;
/// the groups are in order of their first features. With `automatic`, two features are in the same
/// group if they have an edge in common; with `on`, if their boxes meet. `coverage` is not `off`.
/// Rings are clean (see clean_rings.h). On up to `threads` threads.
///
/// What is `known` of an earlier grouping spares looking for it: features of the same number are in
/// the same group whatever the others are, and two of different numbers have no edge in common, or
/// boxes that do not meet; by feature, or empty. The groups are the same without it.
std::vector<std::vector<std::uint32_t>> group_features(std::span<const Rings* const> features,
                                                       CoverageMode coverage, unsigned threads = 1,
                                                       std::span<const std::uint32_t> known = {});

/// Groups of features, as above, such that those of two groups never become one block (see
/// merging.h): beyond kWidestBridge of each other. Those that are near no other are one group, so
/// that courtyards of theirs are filled as well. There is no group of one if there are several
/// features.
std::vector<std::vector<std::uint32_t>> group_for_blocks(std::span<const Rings* const> features);

/// A group, split into the features that share a graph and those that do not; by their positions,
/// in ascending order.
struct Assembly {
  std::vector<std::uint32_t> together;  // in one graph
  std::vector<std::uint32_t> apart;     // each to be built by itself
  CoverageOutcome outcome;              // of those together; built if there are any; its faces are
                                        // those of the graph
};

/// Makes `graph` the graph of those features of a group that can share one, see CoverageBuilder:
/// features that overlap by too much stay apart, and so do all if fewer than two remain or if they
/// cannot be noded. With `on`, only features of a crowd overlap by too much. Gaps of up to
/// `widest_gap` metres are filled. Tells `share`, if there is one, how far it is. On up to
/// `threads` threads; the result does not depend on their number. What is near each other is to
/// become a block as `merging` has it, see CoverageBuilder; features may overlap then, as with
/// `on`.
Assembly assemble(std::span<const Rings* const> features, CoverageMode coverage, double widest_gap,
                  CoverageBuilder& builder, TrapezoidalGraph& graph, WorkShare* share = nullptr,
                  unsigned threads = 1, const Merging& merging = {});

}  // namespace trapeze
