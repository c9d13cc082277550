// From trapezoids to coverage: how much of every pixel the polygons of a layer cover.
//
// The coverage of a pixel is min(1, sum of the exact areas of pixel and trapezoid in common, over
// all trapezoids drawn), computed wide and rounded once, at the end, to 0..255. Trapezoids of one
// polygon do not overlap, so neither seams nor ghost lines can show between them. A trapezoid whose
// left and right edge have changed places has negative area: it takes coverage away.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/web_mercator.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

constexpr int kTilePixels = 256;          // side of a tile at scale 1
constexpr int kMaxPicturePixels = 16384;  // longest side of a picture

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

  /// All grid points whose cells the picture may show; empty if it lies off the world.
  Box box() const;

  /// Throws std::invalid_argument unless 1 <= width, height <= kMaxPicturePixels, cells_per_pixel
  /// is positive and finite, and the origin is within 2^40 cells of the grid's.
  void check() const;
};

/// A raster of coverages: 0 outside, 255 wholly inside; row 0 is the northernmost.
class Coverage {
 public:
  Coverage() = default;
  Coverage(int width, int height) { resize(width, height); }

  /// Afterwards the pixels have no particular values.
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
  /// Gives every pixel the value `level`.
  void fill(std::uint8_t level);
  /// True if every pixel has the value `level`.
  bool is_all(std::uint8_t level) const;

  friend bool operator==(const Coverage&, const Coverage&) = default;

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> pixels_;
};

/// The end of a row: from differences of covered area between each pixel and the one west of it, 1
/// a whole pixel, to as many levels of coverage, rounded once. Leaves zeros behind.
void take_levels(std::span<float> differences, std::uint8_t* levels);
/// The same with differences that are whole numbers, `whole` for a whole pixel; all sums fit into
/// 32 bits.
void take_levels(std::span<std::int32_t> differences, std::int32_t whole, std::uint8_t* levels);

/// Some trapezoids of one mesh; looks at memory of the caller. The ranges lie within the mesh.
struct MeshPart {
  MeshView mesh;
  std::span<const TrapezoidRange> ranges;
};

/// A coverage to be drawn; looks at memory of the caller.
struct CoverageTask {
  std::span<const MeshPart> parts;  // drawn as if they were one mesh
  View view;
  Coverage* out = nullptr;  // is resized to the view
};

/// Milliseconds that the steps of drawing took.
struct DrawTimes {
  double draw_ms = 0;     // adding up areas
  double read_ms = 0;     // from the device to memory
  double resolve_ms = 0;  // from areas to levels
};

/// Draws coverages. All implementations agree within 2/255 in every pixel.
///
/// Thread-safety: one thread at a time may call draw, not necessarily always the same one;
/// different renderers may draw at the same time. forget may be called from any thread at any time.
class CoverageRenderer {
 public:
  virtual ~CoverageRenderer() = default;

  /// Draws each task, with no regard to the others: what a coverage looks like does not depend on
  /// the company in which it is drawn. Throws std::invalid_argument for an impossible view and
  /// std::runtime_error if the device fails (out of memory, context lost); coverages are then
  /// unspecified, the renderer stays usable.
  virtual DrawTimes draw(std::span<const CoverageTask> tasks) = 0;

  void draw(std::span<const MeshPart> parts, const View& view, Coverage& out) {
    const CoverageTask task{parts, view, &out};
    draw(std::span<const CoverageTask>(&task, 1));
  }

  void draw(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const View& view,
            Coverage& out) {
    const MeshPart part{mesh, ranges};
    draw(std::span<const MeshPart>(&part, 1), view, out);
  }

  /// Whether several tasks at once take less time than one after the other.
  virtual bool gains_by_company() const { return false; }

  /// Lets go of whatever is kept for the mesh of that id (uploads). Call it when a mesh goes away.
  virtual void forget([[maybe_unused]] std::uint64_t mesh_id) {}

  /// One word: "software", "egl" or "osmesa".
  virtual std::string_view name() const = 0;
  /// One line for logs: what draws, with versions.
  virtual std::string description() const = 0;
};

}  // namespace trapeze
