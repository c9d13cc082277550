#include "bench/experiment/resimplifying.h"

#include <utility>

#include "bench/experiment/blg_tree.h"
#include "bench/experiment/douglas_peucker.h"
#include "bench/experiment/stopwatch.h"

namespace trapeze::experiment {

void LayerSimplifier::simplify(const Box& box, double epsilon, SimplifiedPolygons& simplified) {
  simplified.clear();
  for (std::size_t p = 0; p < polygons_.size(); ++p) {
    if (!polygons_.boxes[p].intersects(box)) continue;
    chains_.clear();
    for (std::uint32_t ring = polygons_.first_ring(p); ring < polygons_.ends[p]; ++ring) {
      rings_->simplify(ring, epsilon, chains_.chains);
      chains_.ends.push_back(static_cast<std::uint32_t>(chains_.chains.size()));
    }
    if (topology_ == Topology::strict) keeper_.keep(polygons_, p, *rings_, chains_);
    append(p, simplified);
  }
}

void LayerSimplifier::append(std::size_t polygon, SimplifiedPolygons& simplified) const {
  if (chains_.has_gone(0)) return;
  for (std::size_t r = 0; r < chains_.ends.size(); ++r) {
    if (chains_.has_gone(r)) continue;
    const auto ring = polygons_.rings[polygons_.first_ring(polygon) + r];
    for (std::uint32_t c = chains_.first(r); c < chains_.ends[r]; ++c) {
      simplified.rings.points.push_back(ring[chains_.chains[c].begin]);
    }
    simplified.rings.close_ring();
  }
  simplified.ends.push_back(static_cast<std::uint32_t>(simplified.rings.size()));
  simplified.source.push_back(static_cast<std::uint32_t>(polygon));
}

std::unique_ptr<RingSimplifier> make_ring_simplifier(Method method, const PolygonSet& polygons) {
  if (method == Method::douglas_peucker) return std::make_unique<DouglasPeucker>(polygons);
  return std::make_unique<BlgTrees>(polygons);
}

Resimplifying::Resimplifying(Method method, Topology topology, const Map& map, Screen& screen)
    : map_(map), topology_(topology), device_(screen) {
  for (const MapLayer& layer : map.layers) {
    layers_.emplace_back(layer.polygons, make_ring_simplifier(method, layer.polygons), topology);
  }
  if (method == Method::triangulation) triangulation_ = std::make_unique<Triangulation>();
}

std::size_t Resimplifying::shared_memory() const {
  std::size_t bytes = 0;
  for (const MapLayer& layer : map_.layers) bytes += layer.polygons.memory();
  return bytes;
}

// Stage by stage, and not polygon by polygon, so that nobody looks at a clock too often.
ViewCost Resimplifying::draw(const ScaledView& view, std::vector<Coverage>& coverages) {
  const Box box = view.view.box();
  ViewCost cost;
  coverages.resize(layers_.size());
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    Stopwatch stopwatch;
    layers_[i].simplify(box, view.epsilon(), simplified_);
    cost.simplify_ms += stopwatch.lap_ms();
    tessellate(box);
    cost.tessellate_ms += stopwatch.lap_ms();
    device_.send(records_);
    cost.send_ms += stopwatch.lap_ms();
    device_.draw(records_.size(), view.view, coverages[i]);
    cost.draw_ms += stopwatch.lap_ms();
    cost.vertices += simplified_.rings.points.size();
    cost.trapezoids += records_.size();
    cost.bytes += records_.size() * sizeof(TrapezoidRecord);
  }
  return cost;
}

void Resimplifying::tessellate(const Box& box) {
  records_.clear();
  const auto boundary = topology_ == Topology::strict ? OpenTrapezoids::Boundary::simple
                                                      : OpenTrapezoids::Boundary::uncertain;
  for (std::size_t p = 0; p < simplified_.size(); ++p) {
    const std::uint32_t first = simplified_.first_ring(p);
    const std::uint32_t last = simplified_.ends[p];
    if (triangulation_) {
      triangulation_->triangulate(simplified_.rings, first, last, box, records_);
    } else {
      open_trapezoids_.tessellate(simplified_.rings, first, last, box, boundary, records_);
    }
  }
}

}  // namespace trapeze::experiment
