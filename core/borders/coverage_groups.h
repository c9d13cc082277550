// Which polygons of a layer are to live in one graph, because they share borders.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/borders/coverage_builder.h"
#include "core/grid/rings.h"

namespace trapeze {

/// What is done about polygons that share borders.
enum class CoverageMode : std::uint8_t {
  off,        // nothing: each is simplified as if it were alone
  automatic,  // those that have an edge in common, and do not overlap by more than a little
  on,         // all that lie near each other: where they overlap, the last one is drawn
};

/// What is done if nobody says otherwise.
constexpr CoverageMode kUsualCoverage = CoverageMode::off;

/// "off", "auto", "on".
std::optional<CoverageMode> coverage_from_name(std::string_view name);
std::string_view name_of(CoverageMode coverage);

/// Groups of two or more features, each by its position, in ascending order; groups by their first
/// one. Not `off`. Automatically, features are tied by each edge that two of them have; otherwise,
/// by boxes that meet. Rings are clean (see clean_rings.h).
std::vector<std::vector<std::uint32_t>> group_features(std::span<const Rings* const> features,
                                                       CoverageMode coverage);

/// Features of a group, by their positions in ascending order.
struct Assembly {
  std::vector<std::uint32_t> together;  // in one graph, in which that of position i is face i + 1
  std::vector<std::uint32_t> apart;     // to be built each by itself
  CoverageOutcome outcome;              // of those together; built if there are any
};

/// Makes `graph` that of the features of a group that can live in one, see CoverageBuilder: apart
/// stay those that overlap by too much, and all if fewer than two are left or they cannot be noded.
/// Gaps of up to `widest_gap` metres are filled. Tells `share`, if there is one, how far it is.
Assembly assemble(std::span<const Rings* const> features, CoverageMode coverage, double widest_gap,
                  CoverageBuilder& builder, TrapezoidalGraph& graph, WorkShare* share = nullptr);

}  // namespace trapeze
