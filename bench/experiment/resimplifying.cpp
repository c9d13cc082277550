#include "bench/experiment/resimplifying.h"

#include <utility>

#include "bench/experiment/blg_tree.h"
#include "bench/experiment/cpu_clock.h"
#include "bench/experiment/douglas_peucker.h"
#include "render/mask/stopwatch.h"

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
  if (method == Method::douglas_peucker || method == Method::whole_map) {
    return std::make_unique<DouglasPeucker>(polygons);
  }
  return std::make_unique<BlgTrees>(polygons);
}

Resimplifying::Resimplifying(Method method, Topology topology, const Map& map, Screen& screen)
    : map_(map), topology_(topology), is_whole_map_(method == Method::whole_map), device_(screen) {
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

// Stage by stage, not polygon by polygon, so that reading the clock takes no significant time.
ViewCost Resimplifying::draw(const ScaledView& view, std::vector<Mask>& masks) {
  const Box box = is_whole_map_ ? map_.bounds : view.view.box();
  ViewCost cost;
  const double cpu_begin = cpu_clock_ms();
  {
    const Stopwatch stopwatch(cost.simplify_ms);
    simplified_.resize(layers_.size());
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      layers_[i].simplify(box, view.epsilon(), simplified_[i]);
    }
  }
  {
    const Stopwatch stopwatch(cost.tessellate_ms);
    trapezoids_.cut(0);
    ends_.clear();
    for (const SimplifiedPolygons& simplified : simplified_) {
      tessellate(simplified, box);
      ends_.push_back(static_cast<std::uint32_t>(trapezoids_.size()));
    }
  }
  {
    const Stopwatch stopwatch(cost.send_ms);
    device_.send(trapezoids_);
  }
  cost.cpu_before_draw_ms = cpu_clock_ms() - cpu_begin;
  cost.add(device_.draw(ends_, view.view, masks));
  cost.cpu_ms = cpu_clock_ms() - cpu_begin;
  for (const SimplifiedPolygons& simplified : simplified_) {
    cost.vertices += simplified.rings.points.size();
  }
  cost.trapezoids = trapezoids_.size();
  cost.bytes = trapezoids_.size() * sizeof(TrapezoidRecord);
  return cost;
}

void Resimplifying::tessellate(const SimplifiedPolygons& simplified, const Box& box) {
  const auto boundary = topology_ == Topology::strict ? OpenTrapezoids::Boundary::simple
                                                      : OpenTrapezoids::Boundary::uncertain;
  for (std::size_t p = 0; p < simplified.size(); ++p) {
    const std::uint32_t first = simplified.first_ring(p);
    const std::uint32_t last = simplified.ends[p];
    if (triangulation_) {
      triangulation_->triangulate(simplified.rings, first, last, box, trapezoids_);
    } else {
      open_trapezoids_.tessellate(simplified.rings, first, last, box, boundary, trapezoids_);
    }
  }
}

}  // namespace trapeze::experiment
