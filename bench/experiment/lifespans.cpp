#include "bench/experiment/lifespans.h"

#include "bench/experiment/stopwatch.h"

namespace trapeze::experiment {

Lifespans::Lifespans(Method method, Topology topology, const Map& map, Screen& screen)
    : screen_(screen), method_(method) {
  for (const MapLayer& layer : map.layers) {
    layers_.push_back(build_layer(layer, topology));
    screen.send(layers_.back()->mesh());
  }
}

Lifespans::~Lifespans() {
  for (const auto& layer : layers_) screen_.forget(layer->mesh());
}

std::uint64_t Lifespans::sent_before() const {
  std::uint64_t bytes = 0;
  for (const auto& layer : layers_) bytes += layer->mesh().trapezoids.size() * sizeof(TrapezoidRecord);
  return bytes;
}

ViewCost Lifespans::draw(const ScaledView& view, std::vector<Coverage>& coverages) {
  const Layer::Selection selection = selection_of(view);
  ViewCost cost;
  coverages.resize(layers_.size());
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    Stopwatch stopwatch;
    layers_[i]->select(selection, ranges_);
    cost.simplify_ms += stopwatch.lap_ms();
    // The ranges are sent by the call that draws them.
    screen_.renderer().draw(layers_[i]->mesh(), ranges_, view.view, coverages[i]);
    cost.draw_ms += stopwatch.lap_ms();
    for (const TrapezoidRange& range : ranges_) cost.trapezoids += range.count;
    cost.bytes += ranges_.size() * sizeof(TrapezoidRange);
  }
  return cost;
}

Layer::Selection Lifespans::selection_of(const ScaledView& view) const {
  Layer::Selection selection{view.view.box(), view.level, view.level, SmallPolygons::drop};
  if (method_ == Method::lifespans_and_dust) selection.small = SmallPolygons::dust;
  if (method_ == Method::no_simplification) selection.level = 0;
  return selection;
}

}  // namespace trapeze::experiment
