// Draws trapezoids into masks: how much of every pixel is covered by the polygons of a layer.
//
// The value of a pixel is the sum, over all trapezoids drawn, of the exact area of the intersection
// of pixel and trapezoid, as a share of the pixel, clamped to 0..1. The sum is computed with more
// precision than the mask has and rounded once, at the end, to 0..255. Trapezoids of one polygon do
// not overlap, so neither seams nor ghost lines can appear between them. A trapezoid whose left and
// right edges are swapped has negative area, which is subtracted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/cancellation.h"
#include "core/grid/grid.h"
#include "core/grid/web_mercator.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

constexpr int kTilePixels = 256;          // pixels along a side of a tile at scale 1
constexpr int kMaxPicturePixels = 16384;  // maximum for either side of a picture

/// The meaning of the cells of a picture.
enum class Projection : std::uint8_t {
  mercator,      // cells of the grid
  plate_carree,  // equal degrees, see plate_carree.h; boxes and lengths are in grid cells
  plane,         // cells of the grid of another reference system, which does not repeat
};

/// The area that a picture shows. Pixel (column, row) is the rectangle of cells that begins at
/// origin + (column * cells_per_pixel, (first_row + row) * cells_per_row()); row 0 is the
/// northernmost.
struct View {
  std::int64_t origin_x = 0;  // north-west corner of the picture, in cells; may be off the world
  std::int64_t origin_y = 0;
  double cells_per_pixel = 1;  // from west to east
  int width = kTilePixels;     // pixels
  int height = kTilePixels;
  double stretch = 1;  // height of a pixel in cells, divided by its width in cells
  int first_row = 0;   // of a band: the number of rows between the origin and the band
  Projection projection = Projection::mercator;

  /// The view of a tile with 256 * scale pixels per side. `tile` must be valid, 1 <= scale <= 64.
  static View of_tile(const TileId& tile, int scale = 1);

  /// The view of some rows of it, `row` being the first: each is exactly where it is in the whole
  /// picture, to the last bit.
  View band(int row, int rows) const;

  /// Height of a pixel in cells.
  double cells_per_row() const { return cells_per_pixel * stretch; }
  /// The shortest and the longest side that any pixel has, in cells of the grid. In plate carree, a
  /// degree of latitude has 1 / cos(latitude) times as many grid cells as a degree of longitude.
  double shorter_side() const { return cells_per_pixel * (stretch < 1 ? stretch : 1); }
  double longer_side() const;
  /// The side of a square with the area of a pixel, at that y of the grid.
  double side_at(double y) const;

  /// All grid points whose cells the picture may show; empty if the picture is completely off the
  /// world.
  Box box() const;
  /// The same with a margin of that many pixels.
  Box box_around(double pixels) const;
  /// Converts a y of the grid to a row of the picture, and back; off the world, the result is far
  /// from the whole grid.
  double row_from_y(double y) const;
  double y_from_row(double row) const;
  /// Whether no part of it is off the world.
  bool is_on_world() const;

  /// Throws std::invalid_argument unless 1 <= width, height <= kMaxPicturePixels, the sides of a
  /// pixel are positive and finite, and the origin is within 2^40 cells of the grid's.
  void check() const;
};

/// Adjacent pixels of a row with the same value.
struct MaskRun {
  std::uint16_t end = 0;  // the column after the last one
  std::uint8_t value = 0;

  friend bool operator==(const MaskRun&, const MaskRun&) = default;
};

/// An alpha mask: one value per pixel, from 0 (not covered) to 255 (fully covered). It is stored as
/// runs of equal values, so memory and time depend on the boundaries in it and not on its pixels.
/// Row 0 is the northernmost; neighbouring runs of a row have different values.
class Mask {
 public:
  Mask() = default;
  /// Every pixel has that value.
  Mask(int width, int height, std::uint8_t value = 0);

  /// Starts a new mask of width x height pixels, both at most kMaxPicturePixels. Its rows must then
  /// be written one after the other, northernmost first: each from west to east, and finished with
  /// end_row().
  void begin(int width, int height);
  /// Adds pixels to the current row: all up to column `end`, at least one.
  void append(std::size_t end, std::uint8_t value) {
    if (used_ > row_begin_ && runs_[used_ - 1].value == value) {
      runs_[used_ - 1].end = static_cast<std::uint16_t>(end);
    } else {
      append_new(end, value);
    }
  }
  /// The same if the value is known to differ from that of the pixels before.
  void append_new(std::size_t end, std::uint8_t value) {
    runs_[used_++] = {static_cast<std::uint16_t>(end), value};
  }
  void end_row();

  int width() const { return width_; }
  int height() const { return height_; }
  std::span<const MaskRun> row(int row) const {
    const auto i = static_cast<std::size_t>(row);
    const std::uint32_t begin = i == 0 ? 0 : row_end_[i - 1];
    return std::span(runs_).subspan(begin, row_end_[i] - begin);
  }
  /// For few pixels: searches for the run.
  std::uint8_t at(int column, int row) const;
  /// Writes the values of a row; `values` must have room for width() values and kCopyRoom more.
  void copy_row(int row, std::uint8_t* values) const;
  static constexpr std::size_t kCopyRoom = 16;
  /// Whether every pixel has that value.
  bool is_all(std::uint8_t value) const;

  friend bool operator==(const Mask& a, const Mask& b);

 private:
  void make_room_for_row();

  int width_ = 0;
  int height_ = 0;
  std::vector<MaskRun> runs_;  // the first used_ ones, and room for one more row
  std::size_t used_ = 0;
  std::size_t row_begin_ = 0;           // of the current row
  std::vector<std::uint32_t> row_end_;  // by row, the index after its last run
};

/// Calls act(end, value in a, value in b) for the pixels of two rows of equal length, once for each
/// run in which both values are constant.
template <typename Act>
void for_each_run_of_both(std::span<const MaskRun> a, std::span<const MaskRun> b, const Act& act) {
  const MaskRun* next_b = b.data();
  for (const MaskRun& run : a) {
    while (next_b->end < run.end) {
      act(next_b->end, run.value, next_b->value);
      ++next_b;
    }
    act(run.end, run.value, next_b->value);
    if (next_b->end == run.end) ++next_b;
  }
}

/// Combine two masks of equal size, pixel by pixel: the sum, at most 255, and the greater value.
Mask sum_of(const Mask& a, const Mask& b);
Mask greater_of(const Mask& a, const Mask& b);

/// Some trapezoids of a mesh; a view of the caller's memory. The ranges must be within the mesh.
struct MeshPart {
  MeshView mesh;
  std::span<const TrapezoidRange> ranges;
};

/// A mask to be drawn; a view of the caller's memory.
struct MaskTask {
  std::span<const MeshPart> parts;  // drawn as if they were one mesh
  View view;
  Mask* out = nullptr;                         // is resized to the view
  const Cancellation* cancellation = nullptr;  // null: cannot be cancelled
};

/// Milliseconds spent in each step of drawing.
struct DrawTimes {
  double draw_ms = 0;     // summing areas
  double read_ms = 0;     // copying them from the device to memory
  double resolve_ms = 0;  // rounding them to mask values
};

/// Draws masks. The values of any two implementations differ by at most 2 in every pixel.
///
/// Thread-safety: draw must be called by one thread at a time, not necessarily always the same one;
/// different renderers may draw at the same time. forget may be called from any thread at any time.
class MaskRenderer {
 public:
  virtual ~MaskRenderer() = default;

  /// Draws every task. A mask does not depend on the other tasks of the same call. Throws
  /// std::invalid_argument if View::check() refuses a view, Cancelled if one of the tasks was
  /// cancelled, and std::runtime_error if the device fails (out of memory, context lost); the masks
  /// are then unspecified, and the renderer remains usable.
  virtual DrawTimes draw(std::span<const MaskTask> tasks) = 0;

  void draw(std::span<const MeshPart> parts, const View& view, Mask& out) {
    const MaskTask task{parts, view, &out};
    draw(std::span<const MaskTask>(&task, 1));
  }

  void draw(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const View& view,
            Mask& out) {
    const MeshPart part{mesh, ranges};
    draw(std::span<const MeshPart>(&part, 1), view, out);
  }

  /// Whether several tasks in one call take less time than each task in a call of its own.
  virtual bool gains_by_batching() const { return false; }

  /// Frees everything kept for the mesh with that id, such as its copy on the device. Call it when
  /// a mesh is destroyed.
  virtual void forget([[maybe_unused]] std::uint64_t mesh_id) {}

  /// Frees memory that a large picture needed and most do not, also on the device. The same threads
  /// as for draw() may call it.
  virtual void release_memory() {}

  /// One word: "software", "egl" or "osmesa".
  virtual std::string_view name() const = 0;
  /// One line for logs: the device or library used for drawing, with its version.
  virtual std::string description() const = 0;
  /// Renderers with equal identity draw exactly the same masks.
  virtual std::string identity() const { return description(); }
};

}  // namespace trapeze
