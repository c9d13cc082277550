// Marks over a tile that show what it is drawn from.
#pragma once

#include "core/grid/name_table.h"

namespace trapeze {

/// See the paper, Figure 7 f to j.
struct DebugMarks {
  bool faces = false;      // each feature in a colour of its own
  bool mesh = false;       // the sides of the trapezoids
  bool vertices = false;   // the vertices that are kept
  bool junctions = false;  // those of them around which lie three or more features
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
