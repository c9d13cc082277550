// Draws one tile: selects trapezoids, draws coverages, composes colours, encodes the PNG.
//
// Thread-safety: one thread at a time; every worker has its own.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/compose.h"
#include "render/coverage.h"
#include "render/png.h"
#include "server/tile_plan.h"

namespace trapeze {

/// Milliseconds that each step took.
struct PaintTimes {
  double select_ms = 0;
  double draw_ms = 0;
  double compose_ms = 0;
  double encode_ms = 0;
};

struct PaintedTile {
  std::string png;
  PaintTimes times;
};

class TilePainter {
 public:
  using Clock = std::chrono::steady_clock;
  using Deadline = Clock::time_point;

  explicit TilePainter(std::unique_ptr<CoverageRenderer> renderer);

  /// Nothing if the deadline passed before a layer was begun. Throws what the renderer and the
  /// encoder throw.
  std::optional<PaintedTile> paint(const TilePlan& plan, Deadline deadline);

 private:
  void draw_with_places(const Layer& layer, const View& view, Coverage& out);
  void mark(const TilePlan& plan, const View& view, Picture& picture);

  std::unique_ptr<CoverageRenderer> renderer_;
  Composer composer_;
  PngEncoder encoder_;
  // Kept from tile to tile only for their memory.
  std::vector<Coverage> coverages_;
  Picture picture_;
  std::vector<TrapezoidRange> ranges_;
  std::vector<Box> places_;
};

}  // namespace trapeze
