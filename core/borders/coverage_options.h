// How polygons that share borders, or lie near each other, are treated.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/name_table.h"

namespace trapeze {

/// How polygons that share borders are treated.
enum class CoverageMode : std::uint8_t {
  off,        // nothing: each is simplified as if it were alone
  automatic,  // those that have an edge in common, and do not overlap by more than a little
  on,         // all that lie near each other, however much they overlap unless they are a crowd
};

/// The default.
constexpr CoverageMode kUsualCoverage = CoverageMode::automatic;

inline constexpr NameTable<CoverageMode, 3> kCoverageNames({
    {"auto", CoverageMode::automatic},
    {"on", CoverageMode::on},
    {"off", CoverageMode::off},
});

/// What becomes a block.
struct Merging {
  /// The distance that is bridged, as a multiple of the tolerance; 0: none is.
  double ratio = 0;
  /// Only features of one class become one block: the class of each, or empty if all are of one.
  std::vector<std::uint32_t> classes = {};
};

/// Numbers for classes that are given by what they are known by.
std::vector<std::uint32_t> numbered(std::span<const std::uint64_t> classes);

}  // namespace trapeze
