// Outlines: lines along the edges of polygons, by distance.
//
// The coverage of a pixel is how much of the stretch of one pixel, taken across the line, lies
// within the line's width; of several edges the one that covers most counts. So a line is as dark
// where edges meet as anywhere else, and no other renderer is needed: all draw the same.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/grid.h"
#include "render/coverage/coverage.h"

namespace trapeze {

enum class LineJoin : std::uint8_t { bevel, miter, round };

/// Lengths are in pixels of a picture of scale 1.
struct Stroke {
  double width = 0;            // 0: there is none
  std::vector<double> dashes;  // lengths of dashes and gaps in turn, an even number; empty: solid
  LineJoin join = LineJoin::round;  // miters of more than four times the width are bevelled

  /// Whether there are gaps.
  bool is_dashed() const;
  /// How far the line reaches from the edge at most, in pixels of a picture of that scale.
  double reach(int scale) const;

  friend bool operator==(const Stroke&, const Stroke&) = default;
};

/// An edge to draw a line along, between two different points.
struct OutlineEdge {
  std::uint32_t from = 0;  // index of a vertex
  std::uint32_t to = 0;    // index of a vertex
  double along = 0;        // length of the outline up to `from`, in cells; for dashes
};

/// Draws lines one after the other, in memory that it keeps; one a thread.
class Stroker {
 public:
  /// Darkens `levels`, which are as large as the view, where the lines along the edges cover more
  /// than is there. Edges that share a vertex are joined there; all are different.
  void draw(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
            const Stroke& stroke, const View& view, int scale, Coverage& levels);

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
  // What is known of a vertex while lines are joined.
  struct Meeting {
    std::uint32_t vertex = 0;
    std::uint16_t count = 0;  // of lines met there
    bool is_end = false;      // of the first line; else its beginning
    std::uint32_t line = 0;   // the number of the first
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
