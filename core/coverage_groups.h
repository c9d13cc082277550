// Which polygons of a layer are to live in one graph, because they share borders.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/coverage_builder.h"
#include "core/rings.h"

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

/// Of the smaller one of two polygons: what they may overlap by and still be neighbours.
double most_overlap(CoverageMode coverage);

/// Groups of two or more features, each by its position, in ascending order; groups by their first
/// one. Not `off`. Automatically, features are tied by each edge that two of them have; otherwise,
/// by boxes that meet. Rings are clean (see clean_rings.h).
std::vector<std::vector<std::uint32_t>> group_features(std::span<const Rings* const> features,
                                                       CoverageMode coverage);

/// Features, by their positions in ascending order, without which none of those that are left
/// overlaps another by more than `most` of the smaller one: those first that have the most such
/// overlaps, of equals the last one.
std::vector<std::uint32_t> overlapping_features(const CoverageOutcome& outcome, double most);

}  // namespace trapeze
