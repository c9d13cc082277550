// The reference renderer: exact-area coverage in plain C++, no GL.
//
// Every trapezoid is the difference of two half-planes cut to its rows, so it is enough to add up,
// pixel by pixel along its two side edges, how much lies to their right (the left edge counts
// positive, the right edge negative); a running sum along each row turns that into coverage. The
// cost is that of the edges' length in pixels, however large the area between them.
//
// Geometry is computed in double from integer differences: an edge across the whole world is
// placed to better than 1/1000 pixel at zoom 24. Sums are single precision.
#pragma once

#include <cstdint>
#include <vector>

#include "render/coverage/coverage.h"

namespace trapeze {

class SoftwareRenderer final : public CoverageRenderer {
 public:
  using CoverageRenderer::draw;
  DrawTimes draw(std::span<const CoverageTask> tasks) override;

  std::string_view name() const override { return "software"; }
  std::string description() const override;

 private:
  struct Frame;
  struct Piece;

  // The columns of a row that have been added to; first > last if none.
  struct Touched {
    int first;
    int last;
  };

  void draw(const CoverageTask& task, DrawTimes& times);
  void prepare(const View& view);
  void add(const MeshPart& part, const Frame& frame);
  void add_trapezoid(const MeshView& mesh, const MeshTrapezoid& trapezoid, const Frame& frame);
  void add_side(Point upper, Point lower, double y_top, double y_bottom, float sign,
                const Frame& frame);
  void add_clipped(const Piece& piece, float sign);
  void add_piece(const Piece& piece, float sign);
  void add_row(int row, double x_from, double x_to, double height, float sign);
  void resolve(Coverage& out);

  int width_ = 0;
  int height_ = 0;
  std::size_t stride_ = 0;
  // Differences along each row, see above; all zero between two draws. Two columns more than the
  // picture take what falls on and right of its east border.
  std::vector<float> differences_;
  std::vector<Touched> touched_;
};

}  // namespace trapeze
