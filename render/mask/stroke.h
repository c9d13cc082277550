// Outlines: lines along the edges of polygons, drawn by distance from the edge.
//
// The value of a pixel is that share of a segment one pixel long, across the line and centred on
// the pixel, that lies within the width of the line; where several edges are near, the greatest
// value counts. So a line is no darker where edges meet. Outlines are always drawn on the CPU, and
// are the same whichever renderer draws the fill.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/name_table.h"
#include "render/mask/mask.h"

namespace trapeze {

enum class LineJoin : std::uint8_t { bevel, miter, round };

inline constexpr NameTable<LineJoin, 3> kLineJoinNames({
    {"bevel", LineJoin::bevel},
    {"miter", LineJoin::miter},
    {"round", LineJoin::round},
});

/// Lengths are in pixels of a picture of scale 1.
struct Stroke {
  double width = 0;  // 0: no line
  std::vector<double>
      dashes;  // lengths of a dash, a gap, a dash, ...; an even number of them; empty: solid
  LineJoin join = LineJoin::round;  // miters of more than four times the width are bevelled

  /// Whether the line has gaps.
  bool is_dashed() const;
  /// The greatest distance from the edge at which the line covers anything, in pixels of a picture
  /// of that scale.
  double reach(int scale) const;
  /// At most so many values of pixels are computed for lines along so many edges, each not longer
  /// than the line is wide, in a picture of that view and scale.
  std::uint64_t most_values(std::uint64_t edges, const View& view, int scale) const;

  friend bool operator==(const Stroke&, const Stroke&) = default;
};

/// An edge along which a line is drawn; its ends are different points.
struct OutlineEdge {
  std::uint32_t from = 0;  // index of a vertex
  std::uint32_t to = 0;    // index of a vertex
  double along = 0;        // length of the outline up to `from`, in cells: where its dashes begin
};

/// Draws outlines, with working memory that it keeps from one call to the next. One thread at a
/// time may use it.
class Stroker {
 public:
  /// Draws lines along the edges into `mask`: each value becomes the greater of what it was and
  /// what the lines cover. No edge is given twice; edges that share a vertex are joined there.
  /// Throws std::invalid_argument if the mask is not of the size of the view.
  void draw(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
            const Stroke& stroke, const View& view, int scale, Mask& mask);

 private:
  struct Place {
    double x;
    double y;
  };
  // An edge in pixels, with its direction.
  struct Line {
    Place from;
    Place to;
    double dx;
    double dy;
    double length;
    double along;  // at `from`

    Line turned() const;
  };
  // The lines found so far at a vertex, while lines are joined.
  struct Meeting {
    std::uint32_t vertex = 0;
    std::uint16_t count = 0;  // of lines found there
    bool is_end = false;      // whether it is the end of the first line, or else its beginning
    std::uint32_t line = 0;   // the index of the first line
  };
  class Pen;

  void measure(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
               const View& view);
  void meet(std::uint32_t vertex, std::uint32_t line, bool is_end, Pen& pen);
  Line leaving(std::uint32_t line, bool is_end) const;

  std::vector<Line> lines_;
  std::vector<Meeting> meet_;  // by vertex, open addressing
};

}  // namespace trapeze
