// How polygons that share borders or lie near each other are treated.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/name_table.h"

namespace trapeze {

/// How polygons that share borders are treated.
enum class CoverageMode : std::uint8_t {
  off,        // independently: each polygon is simplified as if it were alone
  automatic,  // polygons that share an edge and overlap only a little are treated as a coverage
  on,         // all polygons near each other are, however much they overlap, unless they are a
              // crowd
};

/// The default.
constexpr CoverageMode kUsualCoverage = CoverageMode::automatic;

inline constexpr NameTable<CoverageMode, 3> kCoverageNames({
    {"auto", CoverageMode::automatic},
    {"on", CoverageMode::on},
    {"off", CoverageMode::off},
});

/// Which polygons are merged into blocks.
struct Merging {
  /// The distance that is bridged, as a multiple of the tolerance; 0: nothing is bridged.
  double ratio = 0;
  /// Only features of one class become one block. The class of each feature, or empty if all are of
  /// one class.
  std::vector<std::uint32_t> classes = {};
};

/// Consecutive numbers for classes given by 64-bit keys.
std::vector<std::uint32_t> numbered(std::span<const std::uint64_t> classes);

}  // namespace trapeze
