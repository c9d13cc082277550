#include "core/layer_builder.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "core/layer_contents.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kUnused = 0xffffffff;

/// What one builder holds: the meshes of its features one after another, each with indices of its own.
struct Stock {
  struct Part {
    std::uint32_t row;
    std::size_t vertices;  // where its arrays begin
    std::size_t edges;
    std::size_t trapezoids;
  };
  std::vector<Part> parts;
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<MeshTrapezoid> trapezoids;
  std::vector<Lifespan> lifespans;
};

/// Appends the inside nodes of a graph, alive at all levels.
void append_mesh(const TrapezoidalGraph& graph, std::uint32_t row, Stock& stock) {
  stock.parts.push_back({row, stock.vertices.size(), stock.edges.size(), stock.trapezoids.size()});
  for (std::size_t v = 1; v <= graph.vertex_count(); ++v) stock.vertices.push_back(graph.point(VertexId(v)));
  for (std::size_t e = 0; e + 2 < graph.edges().size(); ++e) {
    const Edge& edge = graph.edge(EdgeId(e));
    stock.edges.push_back({edge.end[kUp].value - 1, edge.end[kDown].value - 1});
  }
  for (const NodeId n : graph.inside_nodes()) {
    const Node& node = graph.node(n);
    stock.trapezoids.push_back({node.end[kUp].value - 1, node.end[kDown].value - 1,
                                node.edge[kLeft].value, node.edge[kRight].value});
    stock.lifespans.push_back({});
  }
}

/// The parts of all builders in the order of features.
struct PartOf {
  const Stock* stock;
  std::size_t part;
};
std::vector<PartOf> in_order_of_rows(const std::vector<const Stock*>& stocks) {
  std::vector<PartOf> parts;
  for (const Stock* stock : stocks) {
    for (std::size_t p = 0; p < stock->parts.size(); ++p) parts.push_back({stock, p});
  }
  std::sort(parts.begin(), parts.end(), [](const PartOf& a, const PartOf& b) {
    return a.stock->parts[a.part].row < b.stock->parts[b.part].row;
  });
  return parts;
}

template <class T>
std::span<const T> part_of(const std::vector<T>& all, const Stock& stock, std::size_t part,
                           std::size_t Stock::Part::*begin) {
  const std::size_t from = stock.parts[part].*begin;
  const std::size_t to = part + 1 < stock.parts.size() ? stock.parts[part + 1].*begin : all.size();
  return std::span<const T>(all).subspan(from, to - from);
}

void concatenate(const std::vector<PartOf>& parts, Layer::Contents& layer) {
  for (const auto& [stock, p] : parts) {
    const auto vertex_base = static_cast<std::uint32_t>(layer.vertices.size());
    const auto edge_base = static_cast<std::uint32_t>(layer.edges.size());
    const auto vertices = part_of(stock->vertices, *stock, p, &Stock::Part::vertices);
    layer.vertices.insert(layer.vertices.end(), vertices.begin(), vertices.end());
    for (const MeshEdge e : part_of(stock->edges, *stock, p, &Stock::Part::edges)) {
      layer.edges.push_back({e.upper + vertex_base, e.lower + vertex_base});
    }
    for (const MeshTrapezoid& t : part_of(stock->trapezoids, *stock, p, &Stock::Part::trapezoids)) {
      layer.trapezoids.push_back(
          {t.top + vertex_base, t.bottom + vertex_base, t.left + edge_base, t.right + edge_base});
      layer.feature_of.push_back(stock->parts[p].row);
    }
    const auto lifespans = part_of(stock->lifespans, *stock, p, &Stock::Part::trapezoids);
    layer.lifespans.insert(layer.lifespans.end(), lifespans.begin(), lifespans.end());
  }
}

template <class T>
void permute(std::vector<T>& items, const std::vector<std::uint32_t>& order) {
  std::vector<T> moved;
  moved.reserve(items.size());
  for (const std::uint32_t i : order) moved.push_back(items[i]);
  items.swap(moved);
}

/// Orders trapezoids for the index; leaves out those without height, which are never drawn.
void order_trapezoids(Layer::Contents& layer) {
  const MeshView view{0, layer.vertices, layer.edges, layer.trapezoids};
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  keys.reserve(layer.trapezoids.size());
  for (std::size_t i = 0; i < layer.trapezoids.size(); ++i) {
    const MeshTrapezoid& t = layer.trapezoids[i];
    if (layer.vertices[t.top].y == layer.vertices[t.bottom].y) continue;
    keys.emplace_back(order_key(box_of(view, t), layer.lifespans[i]), static_cast<std::uint32_t>(i));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const auto& [key, i] : keys) order.push_back(i);
  permute(layer.trapezoids, order);
  permute(layer.lifespans, order);
  permute(layer.feature_of, order);
}

/// Numbers edges and vertices anew in the order in which the trapezoids use them, so that what is
/// drawn together lies together in memory; unused ones go.
void order_edges_and_vertices(Layer::Contents& layer) {
  std::vector<std::uint32_t> number(layer.edges.size(), kUnused);
  std::vector<MeshEdge> edges;
  edges.reserve(layer.edges.size());
  const auto edge = [&](std::uint32_t& e) {
    if (number[e] == kUnused) {
      number[e] = static_cast<std::uint32_t>(edges.size());
      edges.push_back(layer.edges[e]);
    }
    e = number[e];
  };
  for (MeshTrapezoid& t : layer.trapezoids) {
    edge(t.left);
    edge(t.right);
  }
  edges.shrink_to_fit();
  layer.edges.swap(edges);

  number.assign(layer.vertices.size(), kUnused);
  std::vector<Point> vertices;
  vertices.reserve(layer.vertices.size());
  const auto vertex = [&](std::uint32_t& v) {
    if (number[v] == kUnused) {
      number[v] = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back(layer.vertices[v]);
    }
    v = number[v];
  };
  for (MeshEdge& e : layer.edges) {
    vertex(e.upper);
    vertex(e.lower);
  }
  for (MeshTrapezoid& t : layer.trapezoids) {
    vertex(t.top);
    vertex(t.bottom);
  }
  vertices.shrink_to_fit();
  layer.vertices.swap(vertices);
}

std::uint64_t next_mesh_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

struct LayerBuilder::State {
  Stock stock;
  GraphBuilder graph_builder;
  TrapezoidalGraph graph;
};

LayerBuilder::LayerBuilder() : state_(std::make_unique<State>()) {}
LayerBuilder::~LayerBuilder() = default;
LayerBuilder::LayerBuilder(LayerBuilder&&) noexcept = default;
LayerBuilder& LayerBuilder::operator=(LayerBuilder&&) noexcept = default;

BuildOutcome LayerBuilder::add(std::uint32_t row, Rings& rings) {
  BuildOutcome outcome = state_->graph_builder.build(rings, state_->graph);
  if (outcome.built) append_mesh(state_->graph, row, state_->stock);
  return outcome;
}

std::unique_ptr<Layer> LayerBuilder::join(std::vector<LayerBuilder>& builders, FeatureTable features) {
  auto layer = std::make_unique<Layer::Contents>();
  std::vector<const Stock*> stocks;
  for (const LayerBuilder& builder : builders) stocks.push_back(&builder.state_->stock);
  concatenate(in_order_of_rows(stocks), *layer);
  for (LayerBuilder& builder : builders) builder.state_ = std::make_unique<State>();

  order_trapezoids(*layer);
  order_edges_and_vertices(*layer);
  for (const Point p : layer->vertices) layer->bounds.include(p);
  layer->features = std::move(features);
  layer->view = MeshView{next_mesh_id(), layer->vertices, layer->edges, layer->trapezoids};
  layer->index = MeshIndex(layer->view, layer->lifespans);
  return std::make_unique<Layer>(std::move(layer));
}

}  // namespace trapeze
