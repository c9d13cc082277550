// Noding on the integer grid: rings that cross, touch or overlap become edges that meet only at
// shared vertices.
//
// Snap rounding (Hobby 1999; Guibas and Marimont 1998): some cells are "hot", and each segment is
// routed through the centres of all hot cells that it passes through. No point moves by more than
// half a cell in x and in y. Pieces that then coincide cancel in pairs (even-odd).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/rings.h"
#include "core/sweep/boundary.h"
#include "core/sweep/segment.h"

namespace trapeze {

/// All segments of the rings, from each point to the next.
std::vector<Segment> segments_of(const Rings& rings);

enum class HotCells : std::uint8_t {
  /// The cells of crossings and of vertices that lie on other segments. Fast and nearly always
  /// enough, but a segment that is moved may cross another one next to it.
  crossings,
  /// The cells of all vertices as well: the result certainly has no crossing left.
  crossings_and_vertices,
};

/// A piece of a segment, upper end first.
struct Piece {
  Segment segment;
  std::uint32_t source = 0;  // the index of the segment
};

/// How many meetings of so many segments (see meetings.h) make noding worth its time: crossings can
/// be quadratic, but in real data they are a fraction of the number of vertices.
std::size_t most_meetings(std::size_t segments);

/// The result of routing segments through hot cells.
struct Noding {
  std::vector<std::uint32_t> cut;  // segments that change, in ascending order
  std::vector<Piece> pieces;       // their replacements, segment by segment
};

/// Routes the segments through the hot cells; pieces may coincide. The edges of `boundary` are
/// these segments, in the same order. None if they meet more often than most_meetings(), or pass
/// through hot cells so much more often that time and memory would be unbounded. Runs on up to
/// `threads` threads; the result does not depend on their number.
std::optional<Noding> node(const std::vector<Segment>& segments, const Boundary& boundary,
                           HotCells cells, unsigned threads = 1);

/// Routes the segments through the hot cells and returns the pieces, upper end first. An odd number
/// of coinciding pieces yields one piece, an even number none. None under the same conditions.
std::optional<std::vector<Segment>> node_segments(const std::vector<Segment>& segments,
                                                  const Boundary& boundary, HotCells cells);

}  // namespace trapeze
