#include "server/tile_painter.h"

#include <utility>

#include "render/png.h"

namespace trapeze {
namespace {

/// Adds to `sum_ms` the time from its making to its end.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum_ms) : sum_ms_(sum_ms), begin_(TilePainter::Clock::now()) {}
  ~Stopwatch() {
    const auto duration = TilePainter::Clock::now() - begin_;
    sum_ms_ += std::chrono::duration<double, std::milli>(duration).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& sum_ms_;
  const TilePainter::Clock::time_point begin_;
};

}  // namespace

TilePainter::TilePainter(std::unique_ptr<CoverageRenderer> renderer)
    : renderer_(std::move(renderer)) {}

std::optional<PaintedTile> TilePainter::paint(const TilePlan& plan, Deadline deadline) {
  PaintedTile tile;
  const View view = View::of_tile(plan.tile, plan.scale);
  const Box box = view.box();
  if (coverages_.size() < plan.layers.size()) coverages_.resize(plan.layers.size());
  std::vector<FilledLayer> filled;
  for (const LayerPaint& paint : plan.layers) {
    if (Clock::now() > deadline) return std::nullopt;
    const Layer& layer = *plan.dataset->layers()[paint.layer].layer;
    {
      const Stopwatch stopwatch(tile.times.select_ms);
      layer.select(box, plan.level(), SmallPolygons::dust, ranges_);
    }
    if (ranges_.empty()) continue;  // there is nothing of this layer here
    const Stopwatch stopwatch(tile.times.draw_ms);
    Coverage& coverage = coverages_[filled.size()];
    renderer_->draw(layer.mesh(), ranges_, view, coverage);
    filled.push_back({&coverage, paint.fill});
  }
  Picture picture;
  {
    const Stopwatch stopwatch(tile.times.compose_ms);
    picture = compose(filled, view.width, view.height, plan.background);
  }
  {
    const Stopwatch stopwatch(tile.times.encode_ms);
    const auto png = encode_png(picture);
    tile.png.assign(png.begin(), png.end());
  }
  return tile;
}

}  // namespace trapeze
