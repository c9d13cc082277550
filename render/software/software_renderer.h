// The reference renderer: exact covered area in plain C++, without GL.
//
// A trapezoid is the difference of two regions: the area to the right of its left edge, between its
// top and its bottom, minus the area to the right of its right edge. So it is sufficient to add up,
// for each pixel crossed by an edge, the change of the area to the right of the edge (positive for
// the left edge, negative for the right one); a running sum along each row of pixels then gives the
// covered area. The cost is proportional to the length of the edges in pixels, not to the area.
//
// Geometry is computed in double precision from differences of integers: an edge across the whole
// world is placed to better than 1/1000 pixel at zoom 24. Sums are integers, see resolve_row().
// Fractions of a unit are rounded at a threshold that differs from trapezoid to trapezoid (a
// dither), so that errors of thousands of them in one pixel do not all have the same sign. Both
// sides of a trapezoid have the same threshold, and heights are differences of rounded positions:
// so nothing remains east of a trapezoid, and the heights of trapezoids above each other add up.
//
// A mask does not depend on the order of trapezoids, nor on anything off the picture.
#pragma once

#include <cstdint>
#include <vector>

#include "render/mask/mask.h"
#include "render/mask/touched_columns.h"

namespace trapeze {

class SoftwareRenderer final : public MaskRenderer {
 public:
  using MaskRenderer::draw;
  DrawTimes draw(std::span<const MaskTask> tasks) override;

  void release_memory() override;
  std::string_view name() const override { return "software"; }
  std::string description() const override;
  std::string identity() const override { return "software"; }

 private:
  struct Frame;
  struct Piece;
  struct RowPiece;
  struct Rounding;

  void draw(const MaskTask& task, DrawTimes& times);
  void prepare(const View& view);
  /// False if it ended early because the mask was cancelled.
  bool add(const MeshPart& part, const Frame& frame, const Cancellation* cancellation);
  void add_trapezoid(const MeshView& mesh, const MeshTrapezoid& trapezoid, const Frame& frame);
  void add_side(Point upper, Point lower, double y_top, double y_bottom, Rounding rounding,
                const Frame& frame);
  void add_clipped(const Piece& piece, Rounding rounding);
  void add_piece(const Piece& piece, Rounding rounding);
  void add_row(int row, const RowPiece& piece, Rounding rounding);
  void set_aside();
  void resolve(Mask& out);

  int width_ = 0;
  int height_ = 0;
  std::size_t stride_ = 0;
  // Differences along each row, see above; all zero between two draws. Each row has two columns
  // more than the picture, for values on or to the right of its east border.
  std::vector<std::int32_t> differences_;
  TouchedColumns touched_;
  std::uint32_t added_ = 0;         // trapezoids since differences were last set aside
  std::vector<std::int64_t> sums_;  // sums of differences set aside, by pixel; or empty
};

}  // namespace trapeze
