#include "core/layer/layer_builder.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/adapt/history.h"
#include "core/layer/dust.h"
#include "core/layer/layer_contents.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kUnused = 0xffffffff;
// Of the time that building takes, what is spent until there is a graph; measured on countries and
// land use.
constexpr double kGraphShare = 0.25;       // of a single feature
constexpr double kAssemblyShare = 0.45;    // of features that share borders
constexpr double kMostDoubledArea = 9e18;  // what 64 bits hold

/// What one builder holds: the histories of its features and coverages one after another.
struct Stock {
  struct Part {
    std::uint32_t row;     // the first one of a coverage
    std::size_t vertices;  // where its arrays begin
    std::size_t edges;
    std::size_t trapezoids;
    std::size_t horizontal_edges;
    std::size_t grains;
  };
  struct Outline {
    std::uint32_t row;
    std::size_t begin;  // rings
    std::size_t end;
  };
  std::vector<Part> parts;
  History history;
  std::vector<Outline> outlines;
  Rings outline_rings;
};

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

FeatureGrain grain_of(const Grain& grain, double area, std::uint32_t row) {
  const double doubled = std::clamp(2 * area, -kMostDoubledArea, kMostDoubledArea);
  return {grain.from, grain.to, std::llround(doubled), row, grain.born};
}

/// The arrays of a layer while they grow.
struct GrowingLayer {
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<MeshTrapezoid> trapezoids;
  std::vector<Lifespan> lifespans;
  std::vector<std::uint32_t> feature_of;
  std::vector<HorizontalEdge> horizontal_edges;
  std::vector<Grain> grains;
  std::vector<FeatureGrain> feature_grains;
  Rings outlines;
  std::vector<std::uint32_t> outline_ends;
};

/// An area that one feature has taken over from another is the dust of one and less of the other;
/// where features are not told apart, it is as it was.
void add_grain(const Grain& grain, GrowingLayer& layer) {
  layer.feature_grains.push_back(grain_of(grain, grain.area, grain.row));
  if (grain.taker == Grain::kNobody) {
    layer.grains.push_back(grain);
  } else {
    layer.feature_grains.push_back(grain_of(grain, -grain.area, grain.taker));
  }
}

/// Concatenates the histories.
void concatenate(const std::vector<PartOf>& parts, GrowingLayer& layer) {
  for (const auto& [stock, p] : parts) {
    const History& history = stock->history;
    // From indices of the stock to indices of the layer; wraps around where that is negative.
    const auto vertex_shift =
        static_cast<std::uint32_t>(layer.vertices.size() - stock->parts[p].vertices);
    const auto edge_shift = static_cast<std::uint32_t>(layer.edges.size() - stock->parts[p].edges);
    const auto vertices = part_of(history.vertices, *stock, p, &Stock::Part::vertices);
    layer.vertices.insert(layer.vertices.end(), vertices.begin(), vertices.end());
    for (const MeshEdge e : part_of(history.edges, *stock, p, &Stock::Part::edges)) {
      layer.edges.push_back({e.upper + vertex_shift, e.lower + vertex_shift});
    }
    for (const MeshTrapezoid& t :
         part_of(history.trapezoids, *stock, p, &Stock::Part::trapezoids)) {
      layer.trapezoids.push_back({t.top + vertex_shift, t.bottom + vertex_shift,
                                  t.left + edge_shift, t.right + edge_shift});
    }
    const auto rows = part_of(history.rows, *stock, p, &Stock::Part::trapezoids);
    layer.feature_of.insert(layer.feature_of.end(), rows.begin(), rows.end());
    const auto lifespans = part_of(history.lifespans, *stock, p, &Stock::Part::trapezoids);
    layer.lifespans.insert(layer.lifespans.end(), lifespans.begin(), lifespans.end());
    for (HorizontalEdge horizontal_edge :
         part_of(history.horizontal_edges, *stock, p, &Stock::Part::horizontal_edges)) {
      horizontal_edge.edge += edge_shift;
      layer.horizontal_edges.push_back(horizontal_edge);
    }
    for (const Grain& grain : part_of(history.grains, *stock, p, &Stock::Part::grains)) {
      add_grain(grain, layer);
    }
  }
}

/// The outlines of all builders in the order of features.
void concatenate_outlines(const std::vector<const Stock*>& stocks, GrowingLayer& layer) {
  std::vector<std::pair<const Stock*, Stock::Outline>> outlines;
  for (const Stock* stock : stocks) {
    for (const Stock::Outline& outline : stock->outlines) outlines.emplace_back(stock, outline);
  }
  std::sort(outlines.begin(), outlines.end(),
            [](const auto& a, const auto& b) { return a.second.row < b.second.row; });
  for (const auto& [stock, outline] : outlines) {
    layer.outline_ends.resize(outline.row, static_cast<std::uint32_t>(layer.outlines.size()));
    for (std::size_t r = outline.begin; r < outline.end; ++r)
      layer.outlines.add(stock->outline_rings[r]);
    layer.outline_ends.push_back(static_cast<std::uint32_t>(layer.outlines.size()));
  }
}

template <class T>
void permute(std::vector<T>& items, const std::vector<std::uint32_t>& order) {
  std::vector<T> moved;
  moved.reserve(items.size());
  for (const std::uint32_t i : order) moved.push_back(items[i]);
  items.swap(moved);
}

/// Orders trapezoids for the index.
void order_trapezoids(GrowingLayer& layer) {
  const MeshView view{0, layer.vertices, layer.edges, layer.trapezoids};
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  keys.reserve(layer.trapezoids.size());
  for (std::size_t i = 0; i < layer.trapezoids.size(); ++i) {
    const MeshTrapezoid& t = layer.trapezoids[i];
    keys.emplace_back(order_key(box_of(view, t), layer.lifespans[i]),
                      static_cast<std::uint32_t>(i));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const auto& [key, i] : keys) order.push_back(i);
  permute(layer.trapezoids, order);
  permute(layer.lifespans, order);
  permute(layer.feature_of, order);
}

/// A horizontal edge stands behind the trapezoids as one without height, between the edge and
/// itself.
void append_horizontal_edges(GrowingLayer& layer) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  for (std::size_t i = 0; i < layer.horizontal_edges.size(); ++i) {
    const HorizontalEdge& horizontal_edge = layer.horizontal_edges[i];
    const MeshEdge& edge = layer.edges[horizontal_edge.edge];
    Box box;
    box.include(layer.vertices[edge.upper]);
    box.include(layer.vertices[edge.lower]);
    keys.emplace_back(order_key(box, horizontal_edge.lifespan), static_cast<std::uint32_t>(i));
  }
  std::sort(keys.begin(), keys.end());
  for (const auto& [key, i] : keys) {
    const HorizontalEdge& horizontal_edge = layer.horizontal_edges[i];
    const MeshEdge& edge = layer.edges[horizontal_edge.edge];
    layer.trapezoids.push_back(
        {edge.upper, edge.lower, horizontal_edge.edge, horizontal_edge.edge});
    layer.lifespans.push_back(horizontal_edge.lifespan);
    layer.feature_of.push_back(horizontal_edge.row);
  }
}

/// Numbers edges and vertices anew in the order in which the trapezoids use them, so that what is
/// drawn together lies together in memory; unused ones go.
void order_edges_and_vertices(GrowingLayer& layer) {
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

/// The square of a mote as a trapezoid; one of negative area has its edges swapped.
void append_mote(const Mote& mote, GrowingLayer& layer) {
  append_box(box_of_mote(mote.x, mote.y, std::abs(mote.area)), layer.vertices, layer.edges,
             layer.trapezoids);
  if (mote.area < 0) std::swap(layer.trapezoids.back().left, layer.trapezoids.back().right);
  layer.lifespans.push_back(mote.lifespan);
}

/// Single motes first, then merged ones; returns the number of single ones.
std::uint32_t append_dust(const std::vector<Mote>& motes, GrowingLayer& layer) {
  using Key = std::tuple<bool, std::uint64_t, std::uint32_t>;
  std::vector<Key> keys;
  for (std::size_t i = 0; i < motes.size(); ++i) {
    const Point p{static_cast<std::int32_t>(std::lround(motes[i].x)),
                  static_cast<std::int32_t>(std::lround(motes[i].y))};
    keys.emplace_back(motes[i].is_merged, order_key(Box{p.x, p.y, p.x, p.y}, motes[i].lifespan),
                      static_cast<std::uint32_t>(i));
  }
  std::sort(keys.begin(), keys.end());
  layer.vertices.reserve(layer.vertices.size() + 4 * motes.size());
  layer.edges.reserve(layer.edges.size() + 2 * motes.size());
  layer.trapezoids.reserve(layer.trapezoids.size() + motes.size());
  layer.lifespans.reserve(layer.lifespans.size() + motes.size());
  std::uint32_t singles = 0;
  for (const auto& [is_merged, key, i] : keys) {
    append_mote(motes[i], layer);
    singles += !is_merged;
  }
  return singles;
}

void move_arrays(GrowingLayer& from, LayerContents& to) {
  from.outlines.points.shrink_to_fit();
  from.outlines.ends.shrink_to_fit();
  to.vertices = std::move(from.vertices);
  to.edges = std::move(from.edges);
  to.trapezoids = std::move(from.trapezoids);
  to.lifespans = std::move(from.lifespans);
  to.feature_of = std::move(from.feature_of);
  to.outline_points = std::move(from.outlines.points);
  to.ring_ends = std::move(from.outlines.ends);
  to.outline_ends = std::move(from.outline_ends);
}

}  // namespace

struct LayerBuilder::State {
  LayerOptions options;
  Stock stock;
  GraphBuilder graph_builder;
  CoverageBuilder coverage_builder;
  TrapezoidalGraph graph;
  HistoryRecorder recorder;
  WorkShare* share = nullptr;

  void begin_part(std::uint32_t row) {
    const History& history = stock.history;
    stock.parts.push_back({row, history.vertices.size(), history.edges.size(),
                           history.trapezoids.size(), history.horizontal_edges.size(),
                           history.grains.size()});
  }

  void add_outline(std::uint32_t row, const Rings& rings) {
    const std::size_t begin = stock.outline_rings.size();
    for (std::size_t r = 0; r < rings.size(); ++r) stock.outline_rings.add(rings[r]);
    stock.outlines.push_back({row, begin, stock.outline_rings.size()});
  }
};

LayerBuilder::LayerBuilder(const LayerOptions& options, WorkShare* share)
    : state_(std::make_unique<State>()) {
  state_->options = options;
  state_->share = share;
}
LayerBuilder::~LayerBuilder() = default;
LayerBuilder::LayerBuilder(LayerBuilder&&) noexcept = default;
LayerBuilder& LayerBuilder::operator=(LayerBuilder&&) noexcept = default;

BuildOutcome LayerBuilder::add(std::uint32_t row, Rings& rings) {
  BuildOutcome outcome = state_->graph_builder.build(rings, state_->graph);
  if (!outcome.built) return outcome;
  if (state_->share != nullptr) state_->share->enter(kGraphShare, 1);
  state_->begin_part(row);
  state_->add_outline(row, rings_of(state_->graph));
  state_->recorder.record(state_->graph, std::span(&row, 1), state_->options, state_->stock.history,
                          state_->share);
  return outcome;
}

Assembly LayerBuilder::add_coverage(std::span<const std::uint32_t> rows,
                                    std::span<const Rings* const> features) {
  if (state_->share != nullptr) state_->share->enter(0, kAssemblyShare);
  Assembly assembly = assemble(features, state_->options.coverage, state_->options.close_gaps,
                               state_->coverage_builder, state_->graph, state_->share);
  if (assembly.together.empty()) return assembly;
  state_->begin_part(rows[assembly.together.front()]);
  const std::vector<Rings> outlines = rings_of_faces(state_->graph);
  for (const std::uint32_t i : assembly.together) state_->add_outline(rows[i], outlines[i]);
  if (state_->share != nullptr) state_->share->enter(kAssemblyShare, 1);
  state_->recorder.record(state_->graph, rows, state_->options, state_->stock.history,
                          state_->share);
  return assembly;
}

std::unique_ptr<Layer> LayerBuilder::join(std::vector<LayerBuilder>& builders,
                                          FeatureTable features,
                                          const std::function<void(double)>& progress) {
  const auto tell = [&progress](double share) {
    if (progress) progress(share);
  };
  auto layer = std::make_unique<LayerContents>();
  if (!builders.empty()) layer->options = builders.front().state_->options;
  std::vector<const Stock*> stocks;
  stocks.reserve(builders.size());
  for (const LayerBuilder& builder : builders) stocks.push_back(&builder.state_->stock);
  GrowingLayer arrays;
  concatenate(in_order_of_rows(stocks), arrays);
  concatenate_outlines(stocks, arrays);
  for (LayerBuilder& builder : builders) builder = LayerBuilder(builder.state_->options);

  tell(0.2);
  order_trapezoids(arrays);
  tell(0.5);
  const auto polygons = static_cast<std::uint32_t>(arrays.trapezoids.size());
  append_horizontal_edges(arrays);
  const auto horizontal_edges = static_cast<std::uint32_t>(arrays.trapezoids.size());
  order_edges_and_vertices(arrays);
  tell(0.7);
  for (const Point p : arrays.vertices) layer->bounds.include(p);
  layer->size = {arrays.vertices.size(), polygons, arrays.edges.size(), 0};
  const std::uint32_t motes = append_dust(settle(arrays.grains), arrays);
  const auto all = static_cast<std::uint32_t>(arrays.trapezoids.size());
  layer->size.motes = all - horizontal_edges;
  sort_for_index(arrays.feature_grains);
  arrays.feature_grains.shrink_to_fit();

  move_arrays(arrays, *layer);
  layer->features = std::move(features);
  layer->view = MeshView{new_mesh_id(), layer->vertices, layer->edges, layer->trapezoids};
  const auto index = [&layer](std::uint32_t from, std::uint32_t to) {
    return MeshIndex(layer->view, {from, to - from}, layer->lifespans);
  };
  tell(0.8);
  layer->polygon_index = index(0, polygons);
  layer->horizontal_edge_index = index(polygons, horizontal_edges);
  layer->mote_index = index(horizontal_edges, horizontal_edges + motes);
  layer->merged_mote_index = index(horizontal_edges + motes, all);
  layer->grains = GrainIndex(std::move(arrays.feature_grains));
  return std::make_unique<Layer>(std::move(layer));
}

}  // namespace trapeze
