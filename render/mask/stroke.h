// Outlines: lines along the edges of polygons, drawn by distance from the edge.
//
// The value of a pixel is the share of a segment one pixel long, across the line and centred on the
// pixel, that is within the width of the line, times the share of ink given for the edge. If
// several edges are near, the greatest value counts, or, if that is more, the share of the pixel
// that they cover together, by sample points, with the least of their inks (see shared_pixels.h).
// So a line is not darker where edges meet, and lines closer together than they are wide cover what
// they should. Of dashed lines, and of crowds drawn by the nearest edge (see below), the greatest
// value always counts. Outlines are always drawn on the CPU, and are the same with any renderer for
// the fill. They do not depend on the order of the edges.
//
// The outline of a ring that is hardly larger than the line is wide would be a dot as wide as the
// line, and thousands of such rings would make the map black. Its ink should therefore be set with
// Stroke::ink_of_ring().
//
// The cost of a picture is bounded by its pixels and the length of its outlines, and does not
// depend on the width of its lines. If lines are so crowded that more than kCrowd values per pixel
// would be computed, their ends are snapped to a grid of 1/32 pixel, which removes the shortest
// edges, and equal lines are drawn once. If that is not sufficient, lines of four pixels and wider
// are drawn by the nearest edge of every pixel, found for each amount of ink, of which the
// darkest counts: their ends and joins are then round, rims are exact within a tenth of a pixel,
// and where outlines overlap, the dashes of the nearest one are visible.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/cancellation.h"
#include "core/grid/grid.h"
#include "core/grid/name_table.h"
#include "render/mask/canvas.h"
#include "render/mask/mask.h"
#include "render/mask/outline_field.h"
#include "render/mask/shared_pixels.h"

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
      dashes;  // lengths of a dash, a gap, a dash, ...; an even number; empty: solid
  LineJoin join = LineJoin::round;  // miters of more than four times the width are bevelled

  /// Whether the line has gaps.
  bool is_dashed() const;
  /// The greatest distance from the edge at which the line covers anything, in pixels of a picture
  /// of that scale.
  double reach(double scale) const;
  /// The share of ink for the outline of a ring with the area of a circle of that diameter (pixels
  /// of a picture of scale 1): 1 from kFullExtent times the width of the line on, and
  /// proportionally less below. So the outline of a small circle has as much ink as the filled
  /// circle, which is its area.
  double ink_of_ring(double extent) const;
  static constexpr double kFullExtent = 4;
  /// The approximate maximum of pixel values computed for lines along that many edges that are not
  /// longer than wide, in a picture of that view and scale. Never less for more edges or wider
  /// lines.
  std::uint64_t most_values(std::uint64_t edges, const View& view, double scale) const;

  friend bool operator==(const Stroke&, const Stroke&) = default;
};

/// An edge to draw a line along; its ends must be different points.
struct OutlineEdge {
  std::uint32_t from = 0;  // index of a vertex
  std::uint32_t to = 0;    // index of a vertex
  double along = 0;        // length of the outline up to `from`, in cells; positions the dashes
  double rate = 1;         // growth of `along` per cell of the edge
  double ink = 1;          // from 0 to 1: a factor for its values
};

/// Draws outlines, with working memory that is kept from one mask to the next: begin(), then add()
/// for all edges, draw() and finish(). One thread at a time.
class Stroker {
 public:
  /// The average number of values computed per pixel above which a picture counts as crowded.
  static constexpr std::uint64_t kCrowd = 64;

  /// Starts a picture of that view and scale, without lines.
  void begin(const View& view, double scale);
  /// Adds edges between vertices. Each edge must be added only once; edges added together that
  /// share a vertex are joined there.
  void add(std::span<const Point> vertices, std::span<const OutlineEdge> edges);
  /// Draws lines along all edges that were added. Throws Cancelled.
  void draw(const Stroke& stroke, const Cancellation* cancellation = nullptr);
  /// Finishes the picture.
  void finish(Mask& mask);

  /// The work of the last draw(): pixel values computed, and steps of OutlineField.
  std::uint64_t values() const { return values_; }

 private:
  // An edge in pixels, with its direction.
  struct Line {
    PicturePlace from;
    PicturePlace to;
    double dx;
    double dy;
    double length;
    double along;  // at `from`
    double rate;   // per pixel
    float ink;

    Line turned() const;
    /// The same line with other ends.
    Line between(PicturePlace new_from, PicturePlace new_to) const;
  };
  // Numbers that identify the ends of a line among all that were added.
  struct Ends {
    std::uint64_t from;
    std::uint64_t to;
  };
  // The lines found so far at a place, while lines are joined.
  struct Meeting {
    std::uint64_t place = 0;
    std::uint32_t line = 0;   // the index of the first line
    std::uint16_t count = 0;  // number of lines found there
    bool is_end = false;      // whether it is the end of the first line, not its beginning
  };
  struct Rows {
    int begin;
    int end;
  };
  class Pen;

  void sort_lines();
  double most_values_of_lines(const Pen& pen) const;
  double values_of_lines(const Pen& pen) const;
  void merge_lines();
  void draw_each(Pen& pen, const Cancellation* cancellation);
  void draw_band(Pen& pen, CancellationCheck& check);
  void darken_shared(Rows band);
  void join_lines(Pen& pen, CancellationCheck& check);
  void meet(std::uint64_t place, std::uint32_t line, bool is_end, Pen& pen);
  Line leaving(std::uint32_t line, bool is_end) const;
  void draw_nearest(const Pen& pen, const Cancellation* cancellation);
  std::vector<std::uint32_t> by_ink() const;

  View view_;
  double scale_ = 1;
  Canvas canvas_;
  std::vector<Line> lines_;
  std::vector<Ends> ends_;      // by line
  std::uint64_t vertices_ = 0;  // number of those that were added
  double length_of_lines_ = 0;
  std::vector<Meeting> meet_;             // by place, open addressing
  std::vector<std::uint8_t> directions_;  // by line: numbers of HalfPlanes
  SharedPixels shared_;                   // of a band of rows
  OutlineField field_;
  std::uint64_t values_ = 0;
};

}  // namespace trapeze
