#include "bench/experiment/lifespans.h"

#include "bench/experiment/cpu_clock.h"
#include "render/mask/stopwatch.h"

namespace trapeze::experiment {

Lifespans::Lifespans(Method method, Topology topology, const Map& map, Screen& screen)
    : screen_(screen), method_(method) {
  for (const MapLayer& layer : map.layers) {
    layers_.push_back(build_layer(layer, topology));
    meshes_.push_back(layers_.back()->mesh());
    screen.send(meshes_.back());
  }
}

Lifespans::~Lifespans() {
  for (const MeshView& mesh : meshes_) screen_.forget(mesh.id);
}

std::uint64_t Lifespans::sent_before() const {
  std::uint64_t bytes = 0;
  for (const MeshView& mesh : meshes_) bytes += mesh.trapezoids.size() * sizeof(TrapezoidRecord);
  return bytes;
}

ViewCost Lifespans::draw(const ScaledView& view, std::vector<Mask>& masks) {
  const Layer::Selection selection = selection_of(view);
  ViewCost cost;
  const double cpu_begin = cpu_clock_ms();
  {
    const Stopwatch stopwatch(cost.simplify_ms);
    ranges_.resize(layers_.size());
    for (std::size_t i = 0; i < layers_.size(); ++i) layers_[i]->select(selection, ranges_[i]);
  }
  cost.cpu_before_draw_ms = cpu_clock_ms() - cpu_begin;
  cost.add(screen_.draw(meshes_, ranges_, view.view, masks));
  cost.cpu_ms = cpu_clock_ms() - cpu_begin;
  for (const Ranges& ranges : ranges_) {
    for (const TrapezoidRange& range : ranges) cost.trapezoids += range.count;
    cost.bytes += ranges.size() * sizeof(TrapezoidRange);
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
