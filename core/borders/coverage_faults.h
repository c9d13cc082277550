// Where the features of a coverage do not fit together: places between them that none covers, and
// places that several cover. For reports; drawing does not need them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/borders/polygons.h"
#include "core/grid/name_table.h"
#include "core/grid/rings.h"

namespace trapeze {

enum class FaultKind : std::uint8_t { gap, overlap };

inline constexpr NameTable<FaultKind, 2> kFaultNames({
    {"gap", FaultKind::gap},
    {"overlap", FaultKind::overlap},
});

/// A connected place.
struct CoverageFault {
  FaultKind kind = FaultKind::gap;
  double area = 0;   // square metres on the ground, at the latitude of the place
  double width = 0;  // metres on the ground: the area over half of the boundary, as of a strip
  /// Of an overlap those that cover the place, of a gap those around it, two at least; by their
  /// positions, in ascending order.
  std::vector<std::uint32_t> features;
  Polygons polygons;
};

struct CoverageFaults {
  std::vector<CoverageFault> faults;
  std::string failure;  // why they could not be found, empty otherwise
};

/// All of them. Each feature is by even-odd of its own rings, which are clean (see clean_rings.h).
/// A hole of one feature that no other one touches is no gap.
CoverageFaults find_faults(std::span<const Rings* const> features);

}  // namespace trapeze
