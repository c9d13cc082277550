// Faults of a coverage: gaps between features that none covers, and overlaps. For reports; drawing
// does not need them.
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

/// A connected gap or overlap.
struct CoverageFault {
  FaultKind kind = FaultKind::gap;
  double area = 0;   // square metres on the ground
  double width = 0;  // metres on the ground: the area over half of the boundary, as for a strip
  /// For an overlap, the features that cover the place; for a gap, the features around it (two at
  /// least). By position, in ascending order.
  std::vector<std::uint32_t> features;
  Polygons polygons;
};

struct CoverageFaults {
  std::vector<CoverageFault> faults;
  std::string failure;  // why they could not be found, empty otherwise
};

/// Finds all faults. Each feature is defined by even-odd of its own rings, which are clean (see
/// clean_rings.h). A hole of one feature that no other feature touches is no gap.
CoverageFaults find_faults(std::span<const Rings* const> features);

}  // namespace trapeze
