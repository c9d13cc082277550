// Marks over a tile that show the data it is drawn from.
#pragma once

#include "core/grid/name_table.h"

namespace trapeze {

/// See the paper, Figure 7 f to j.
struct DebugMarks {
  bool faces = false;      // each feature in its own colour
  bool mesh = false;       // the sides of the trapezoids
  bool vertices = false;   // the vertices that are left
  bool junctions = false;  // those where three or more features meet
  bool tile = false;       // the border of the tile, with its numbers

  bool any() const { return faces || mesh || vertices || junctions || tile; }
  friend bool operator==(const DebugMarks&, const DebugMarks&) = default;
};

inline constexpr NameTable<bool DebugMarks::*, 5> kDebugMarkNames({
    {"faces", &DebugMarks::faces},
    {"junctions", &DebugMarks::junctions},
    {"mesh", &DebugMarks::mesh},
    {"tile", &DebugMarks::tile},
    {"vertices", &DebugMarks::vertices},
});

}  // namespace trapeze
