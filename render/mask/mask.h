// From trapezoids to masks: how much of every pixel the polygons of a layer cover.
//
// The value of a pixel is the sum, over all trapezoids drawn, of the exact area that pixel and
// trapezoid have in common, as a share of the pixel, clamped to 0..1. The sum is computed with more
// precision than the mask has and rounded once, at the end, to 0..255. Trapezoids of one polygon do
// not overlap, so neither seams nor ghost lines can show between them. A trapezoid whose left and
// right edges have been swapped has negative area, which is subtracted.
#pragma once

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
constexpr int kMaxPicturePixels = 16384;  // at most, along either side of a picture

/// What a picture shows. Pixel (column, row) is the square of cells that begins at
/// origin + (column, row) * cells_per_pixel; row 0 is the northernmost.
struct View {
  std::int64_t origin_x = 0;  // north-west corner of the picture, in cells; may lie off the world
  std::int64_t origin_y = 0;
  double cells_per_pixel = 1;
  int width = kTilePixels;  // pixels
  int height = kTilePixels;

  /// A tile of 256 * scale pixels a side. `tile` is valid, 1 <= scale <= 64.
  static View of_tile(const TileId& tile, int scale = 1);

  /// All grid points whose cells the picture may show, in cells; empty if the picture lies wholly
  /// off the world.
  Box box() const;

  /// Throws std::invalid_argument unless 1 <= width, height <= kMaxPicturePixels, cells_per_pixel
  /// is positive and finite, and the origin is within 2^40 cells of the grid's.
  void check() const;
};

/// An alpha mask: one value a pixel, from 0 (not covered) to 255 (wholly covered). Row 0 is the
/// northernmost.
class Mask {
 public:
  Mask() = default;
  Mask(int width, int height) { resize(width, height); }

  /// Sets the size in pixels; the values are unspecified afterwards.
  void resize(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  std::uint8_t at(int column, int row) const { return row_begin(row)[column]; }
  std::span<const std::uint8_t> pixels() const { return pixels_; }
  std::uint8_t* row_begin(int row) {
    return pixels_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
  }
  const std::uint8_t* row_begin(int row) const {
    return pixels_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
  }
  void fill(std::uint8_t value);
  /// Whether every pixel has that value.
  bool is_all(std::uint8_t value) const;

  friend bool operator==(const Mask&, const Mask&) = default;

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> pixels_;
};

/// Turns one row of differences into mask values: the running sum of the differences is the area
/// covered of each pixel, 1 being a whole pixel; it is clamped and rounded once. `values` has room
/// for as many values as there are differences. Sets the differences to 0.
void resolve_row(std::span<float> differences, std::uint8_t* values);
/// The same where it is known in which blocks of columns there are differences other than 0: bit b
/// of `touched` stands for the columns from b << shift on. Precondition: shift >= 3.
void resolve_row(std::span<float> differences, std::uint64_t touched, unsigned shift,
                 std::uint8_t* values);
/// The same as the first for integer differences, `whole` being a whole pixel. Precondition: every
/// running sum fits into 32 bits.
void resolve_row(std::span<std::int32_t> differences, std::int32_t whole, std::uint8_t* values);

/// Some trapezoids of one mesh; a view of the caller's memory. The ranges lie within the mesh.
struct MeshPart {
  MeshView mesh;
  std::span<const TrapezoidRange> ranges;
};

/// A mask to be drawn; a view of the caller's memory.
struct MaskTask {
  std::span<const MeshPart> parts;  // drawn as if they were one mesh
  View view;
  Mask* out = nullptr;                         // is resized to the view
  const Cancellation* cancellation = nullptr;  // null: wanted whatever happens
};

/// Milliseconds that the steps of drawing took.
struct DrawTimes {
  double draw_ms = 0;     // adding up areas
  double read_ms = 0;     // copying them from the device to memory
  double resolve_ms = 0;  // rounding them to mask values
};

/// Draws masks. The values of any two implementations differ by at most 2 in every pixel.
///
/// Thread-safety: one thread at a time may call draw, not necessarily always the same one;
/// different renderers may draw at the same time. forget may be called from any thread at any time.
class MaskRenderer {
 public:
  virtual ~MaskRenderer() = default;

  /// Draws every task. A mask does not depend on which other tasks are drawn in the same call.
  /// Throws std::invalid_argument if View::check() refuses a view, Cancelled if one of the tasks is
  /// not wanted any longer, and std::runtime_error if the device fails (out of memory, context
  /// lost); the masks are then unspecified, and the renderer remains usable.
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

  /// Whether several tasks in one call take less time than the same tasks in a call each.
  virtual bool gains_by_batching() const { return false; }

  /// Frees what is kept for the mesh of that id, such as its copy on the device. To be called when
  /// a mesh is destroyed.
  virtual void forget([[maybe_unused]] std::uint64_t mesh_id) {}

  /// Frees memory that a large picture needed and most do not, on the device too. As draw() is
  /// called.
  virtual void release_memory() {}

  /// One word: "software", "egl" or "osmesa".
  virtual std::string_view name() const = 0;
  /// One line for logs: the device or library that draws, with its version.
  virtual std::string description() const = 0;
};

}  // namespace trapeze
