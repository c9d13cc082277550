#include "bench/experiment/adapting.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "bench/experiment/cpu_clock.h"
#include "core/sweep/graph_builder.h"
#include "render/mask/stopwatch.h"

namespace trapeze::experiment {
namespace {

bool is_within(const Box& inner, const Box& outer) {
  return outer.min_x <= inner.min_x && inner.max_x <= outer.max_x && outer.min_y <= inner.min_y &&
         inner.max_y <= outer.max_y;
}

}  // namespace

AdaptingLayer::AdaptingLayer(const PolygonSet& polygons, Topology topology,
                             std::vector<Point>& vertices)
    : vertices_(vertices) {
  GraphBuilder builder;
  Rings rings;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    rings.clear();
    for (std::uint32_t r = polygons.first_ring(p); r < polygons.ends[p]; ++r) {
      rings.add(polygons.rings[r]);
    }
    TrapezoidalGraph graph;
    if (!builder.build(rings, graph).built) continue;
    polygons_.emplace_back();
    polygons_.back().box = polygons.boxes[p];
    polygons_.back().first_vertex = static_cast<std::uint32_t>(vertices.size());
    for (std::size_t v = 1; v <= graph.vertex_count(); ++v) {
      vertices.push_back(graph.point(VertexId(v)));
    }
    graphs_.emplace_back(std::move(graph), GeneralizationOptions{.topology = topology});
    graphs_.back().adapt_to(std::numeric_limits<double>::max());
  }
  start_run();
}

void AdaptingLayer::start_run() {
  for (std::size_t p = 0; p < polygons_.size(); ++p) adapt(p, 0);
}

void AdaptingLayer::adapt(const Box& box, double epsilon) {
  for (std::size_t p = 0; p < polygons_.size(); ++p) {
    if (polygons_[p].unchanged.contains(epsilon) || !polygons_[p].box.intersects(box)) continue;
    adapt(p, epsilon);
  }
}

void AdaptingLayer::adapt(std::size_t polygon, double epsilon) {
  graphs_[polygon].adapt_to(epsilon);
  polygons_[polygon].unchanged = graphs_[polygon].unchanged();
  polygons_[polygon].is_listed = false;
}

void AdaptingLayer::append_trapezoids(const Box& box, NumberedList& trapezoids) {
  for (std::size_t p = 0; p < polygons_.size(); ++p) {
    const Polygon& polygon = polygons_[p];
    if (!polygon.box.intersects(box)) continue;
    if (!polygon.is_listed) list(p);
    const NumberedList& own = polygon.trapezoids;
    if (own.empty()) continue;
    if (is_within(polygon.box, box)) {
      trapezoids.insert(trapezoids.end(), own.begin(), own.end());
    } else {
      const auto count = static_cast<std::uint32_t>(graphs_[p].graph().vertex_count());
      append_within(polygon, count, box, trapezoids);
    }
  }
}

void AdaptingLayer::list(std::size_t p) {
  const TrapezoidalGraph& graph = graphs_[p].graph();
  Polygon& polygon = polygons_[p];
  const auto number = [&](VertexId v) { return polygon.first_vertex + v.value - 1; };
  polygon.trapezoids.clear();
  polygon.reaches.clear();
  for (const Node& node : graph.nodes()) {
    if (!node.is_alive() || graph.face(node) == kOutside) continue;
    if (graph.point(node.end[kUp]).y == graph.point(node.end[kDown]).y) continue;
    const Edge& left = graph.edge(node.edge[kLeft]);
    const Edge& right = graph.edge(node.edge[kRight]);
    polygon.trapezoids.push_back({number(node.end[kUp]), number(node.end[kDown]),
                                  number(left.end[kUp]), number(left.end[kDown]),
                                  number(right.end[kUp]), number(right.end[kDown])});
    polygon.reaches.push_back(
        {std::min(graph.point(left.end[kUp]).x, graph.point(left.end[kDown]).x),
         std::max(graph.point(right.end[kUp]).x, graph.point(right.end[kDown]).x)});
  }
  polygon.is_listed = true;
}

// Vertices are numbered from top to bottom, so levels can be compared by numbers.
void AdaptingLayer::append_within(const Polygon& polygon, std::uint32_t vertex_count,
                                  const Box& box, NumberedList& trapezoids) const {
  const auto first = vertices_.begin() + polygon.first_vertex;
  const auto number_at = [&](std::int32_t y) {
    const auto found =
        std::partition_point(first, first + vertex_count, [y](Point q) { return q.y < y; });
    return static_cast<std::uint32_t>(found - vertices_.begin());
  };
  const std::uint32_t from = number_at(box.min_y);
  const std::uint32_t to = number_at(box.max_y);
  const NumberedList& own = polygon.trapezoids;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (own[i].bottom < from || own[i].top > to) continue;
    const Reach& reach = polygon.reaches[i];
    if (reach.max_x < box.min_x || reach.min_x > box.max_x) continue;
    trapezoids.push_back(own[i]);
  }
}

Adapting::Adapting(Topology topology, const Map& map, Screen& screen) {
  for (const MapLayer& layer : map.layers) {
    layers_.emplace_back(layer.polygons, topology, vertices_);
  }
  device_ = std::make_unique<NumberedTrapezoids>(screen, vertices_);
}

void Adapting::start_run() {
  for (AdaptingLayer& layer : layers_) layer.start_run();
}

ViewCost Adapting::draw(const ScaledView& view, std::vector<Mask>& masks) {
  const Box box = view.view.box();
  ViewCost cost;
  const double cpu_begin = cpu_clock_ms();
  {
    const Stopwatch stopwatch(cost.simplify_ms);
    for (AdaptingLayer& layer : layers_) layer.adapt(box, view.epsilon());
  }
  {
    const Stopwatch stopwatch(cost.send_ms);
    trapezoids_.clear();
    ends_.clear();
    for (AdaptingLayer& layer : layers_) {
      layer.append_trapezoids(box, trapezoids_);
      ends_.push_back(static_cast<std::uint32_t>(trapezoids_.size()));
    }
    device_->send(trapezoids_);
  }
  cost.cpu_before_draw_ms = cpu_clock_ms() - cpu_begin;
  cost.add(device_->draw(ends_, view.view, masks));
  cost.cpu_ms = cpu_clock_ms() - cpu_begin;
  cost.trapezoids = trapezoids_.size();
  cost.bytes = trapezoids_.size() * sizeof(VertexNumbers);
  return cost;
}

}  // namespace trapeze::experiment
