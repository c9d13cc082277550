#include "bench/experiment/adapting.h"

#include <algorithm>
#include <limits>

#include "bench/experiment/stopwatch.h"
#include "core/graph_builder.h"

namespace trapeze::experiment {

AdaptingLayer::AdaptingLayer(const PolygonSet& polygons, Topology topology, Screen& screen) {
  GraphBuilder builder;
  Rings rings;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    rings.clear();
    for (std::uint32_t r = polygons.first_ring(p); r < polygons.ends[p]; ++r) {
      rings.add(polygons.rings[r]);
    }
    TrapezoidalGraph graph;
    if (!builder.build(rings, graph).built) continue;
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    for (std::size_t v = 1; v <= graph.vertex_count(); ++v) {
      vertices_.push_back(graph.point(VertexId(v)));
    }
    polygons_.push_back({polygons.boxes[p], first, false, {}, {}});
    graphs_.emplace_back(std::move(graph), GeneralizationOptions{.topology = topology});
    graphs_.back().adapt_to(std::numeric_limits<double>::max());
  }
  device_ = std::make_unique<NumberedTrapezoids>(screen, vertices_);
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

const std::vector<VertexNumbers>& AdaptingLayer::list_trapezoids(const Box& box) {
  in_box_.clear();
  for (std::size_t p = 0; p < polygons_.size(); ++p) {
    if (!polygons_[p].box.intersects(box)) continue;
    if (!polygons_[p].is_listed) list(p);
    append_in_box(p, box);
  }
  return in_box_;
}

void AdaptingLayer::list(std::size_t polygon) {
  const TrapezoidalGraph& graph = graphs_[polygon].graph();
  Polygon& listed = polygons_[polygon];
  const auto number = [&](VertexId v) { return listed.first_vertex + v.value - 1; };
  listed.trapezoids.clear();
  for (const Node& node : graph.nodes()) {
    if (!node.is_alive() || graph.face(node) == kOutside) continue;
    const Edge& left = graph.edge(node.edge[kLeft]);
    const Edge& right = graph.edge(node.edge[kRight]);
    if (graph.point(node.end[kUp]).y == graph.point(node.end[kDown]).y) continue;
    listed.trapezoids.push_back({number(node.end[kUp]), number(node.end[kDown]),
                                 number(left.end[kUp]), number(left.end[kDown]),
                                 number(right.end[kUp]), number(right.end[kDown])});
  }
  listed.is_listed = true;
}

// Numbers of vertices follow each other from top to bottom, so that levels are compared by numbers.
void AdaptingLayer::append_in_box(std::size_t p, const Box& box) {
  const Polygon& polygon = polygons_[p];
  if (box.min_y <= polygon.box.min_y && polygon.box.max_y <= box.max_y) {
    in_box_.insert(in_box_.end(), polygon.trapezoids.begin(), polygon.trapezoids.end());
    return;
  }
  if (polygon.trapezoids.empty()) return;
  const auto first = vertices_.begin() + polygon.first_vertex;
  const auto last = first + static_cast<std::ptrdiff_t>(graphs_[p].graph().vertex_count());
  const auto number_at = [&](std::int32_t y) {
    const auto found = std::partition_point(first, last, [y](Point q) { return q.y < y; });
    return static_cast<std::uint32_t>(found - vertices_.begin());
  };
  const std::uint32_t from = number_at(box.min_y);
  const std::uint32_t to = number_at(box.max_y);
  for (const VertexNumbers& trapezoid : polygon.trapezoids) {
    if (trapezoid.bottom >= from && trapezoid.top <= to) in_box_.push_back(trapezoid);
  }
}

Adapting::Adapting(Topology topology, const Map& map, Screen& screen) {
  for (const MapLayer& layer : map.layers) {
    layers_.emplace_back(layer.polygons, topology, screen);
  }
}

void Adapting::start_run() {
  for (AdaptingLayer& layer : layers_) layer.start_run();
}

std::uint64_t Adapting::sent_before() const {
  std::uint64_t bytes = 0;
  for (const AdaptingLayer& layer : layers_) bytes += layer.vertex_count() * sizeof(Point);
  return bytes;
}

ViewCost Adapting::draw(const ScaledView& view, std::vector<Coverage>& coverages) {
  const Box box = view.view.box();
  ViewCost cost;
  coverages.resize(layers_.size());
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    Stopwatch stopwatch;
    layers_[i].adapt(box, view.epsilon());
    cost.simplify_ms += stopwatch.lap_ms();
    const std::vector<VertexNumbers>& trapezoids = layers_[i].list_trapezoids(box);
    layers_[i].device().send(trapezoids);
    cost.send_ms += stopwatch.lap_ms();
    layers_[i].device().draw(trapezoids.size(), view.view, coverages[i]);
    cost.draw_ms += stopwatch.lap_ms();
    cost.trapezoids += trapezoids.size();
    cost.bytes += trapezoids.size() * sizeof(VertexNumbers);
  }
  return cost;
}

}  // namespace trapeze::experiment
