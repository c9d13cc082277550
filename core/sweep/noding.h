// Noding on the integer grid: rings that cross, touch or overlap become edges that meet only at
// common vertices.
//
// Snap rounding (Hobby 1999; Guibas and Marimont 1998): cells are made "hot", and each segment is
// led through the centres of all hot cells that it passes. No point moves by more than half a cell
// in x and y. Pieces that then coincide cancel in pairs (even-odd).
#pragma once

#include <cstdint>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/rings.h"
#include "core/sweep/segment.h"

namespace trapeze {

/// All segments of the rings, from each point to the next.
std::vector<Segment> segments_of(const Rings& rings);

enum class HotCells : std::uint8_t {
  /// Those of crossings and of vertices that lie on other segments. Quick, and nearly always
  /// enough; but a segment that
  /// is moved can come to cross another one next to it.
  crossings,
  /// Those of all vertices as well: the result is certain to have no crossing left.
  crossings_and_vertices,
};

/// A piece of a segment, upper end first.
struct Piece {
  Segment segment;
  std::uint32_t source = 0;  // the index of the segment
};

/// Leads the segments through the hot cells and returns all pieces, those that coincide as well.
std::vector<Piece> node_pieces(const std::vector<Segment>& segments, HotCells cells);

/// Leads the segments through the hot cells and returns the pieces, upper end first; those that
/// coincide an odd number of times once, an even number of times not at all.
std::vector<Segment> node_segments(const std::vector<Segment>& segments, HotCells cells);

}  // namespace trapeze
