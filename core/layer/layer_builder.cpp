#include "core/layer/layer_builder.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/adapt/history.h"
#include "core/grid/item_count.h"
#include "core/layer/dust.h"
#include "core/layer/layer_contents.h"
#include "core/layer/overlaps.h"

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
    std::size_t milestones;
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
  std::vector<FeatureOverlap> shared;  // of features with a face of a coverage in common
};

/// A part of a builder, and what leads from indices of its stock to indices of the layer; wraps
/// around where that is negative.
struct PartOf {
  const Stock* stock;
  std::size_t part;
  std::uint32_t vertex_shift = 0;
  std::uint32_t edge_shift = 0;
};

template <class T>
std::span<const T> items_of(const PartOf& part, std::vector<T> History::*items,
                            std::size_t Stock::Part::*begin) {
  const std::vector<T>& all = part.stock->history.*items;
  const std::vector<Stock::Part>& parts = part.stock->parts;
  const std::size_t from = parts[part.part].*begin;
  const std::size_t to = part.part + 1 < parts.size() ? parts[part.part + 1].*begin : all.size();
  return std::span<const T>(all).subspan(from, to - from);
}

/// The parts of all builders in the order of features.
std::vector<PartOf> in_order_of_rows(const std::vector<Stock>& stocks) {
  std::vector<PartOf> parts;
  for (const Stock& stock : stocks) {
    for (std::size_t p = 0; p < stock.parts.size(); ++p) parts.push_back({&stock, p});
  }
  std::sort(parts.begin(), parts.end(), [](const PartOf& a, const PartOf& b) {
    return a.stock->parts[a.part].row < b.stock->parts[b.part].row;
  });
  std::size_t vertices = 0;
  std::size_t edges = 0;
  for (PartOf& part : parts) {
    const Stock::Part& begin = part.stock->parts[part.part];
    part.vertex_shift = static_cast<std::uint32_t>(vertices - begin.vertices);
    part.edge_shift = static_cast<std::uint32_t>(edges - begin.edges);
    vertices += items_of(part, &History::vertices, &Stock::Part::vertices).size();
    edges += items_of(part, &History::edges, &Stock::Part::edges).size();
  }
  return parts;
}

/// The arrays of a layer while they grow.
struct GrowingLayer {
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<LoopSize> loop_sizes;
  std::vector<MilestoneNote> milestone_notes;
  std::vector<MeshTrapezoid> trapezoids;
  std::vector<Lifespan> lifespans;
  std::vector<std::uint32_t> feature_of;
  std::vector<HorizontalEdge> horizontal_edges;
  std::vector<Grain> grains;
  std::vector<FeatureGrain> feature_grains;
  Rings outlines;
  std::vector<std::uint32_t> outline_ends;
  std::vector<std::uint32_t> graph_of;  // by row
  std::vector<FeatureOverlap> shared;   // of features of one graph
};

/// Where features are not told apart, a place that others cover is as it was.
void add_grain(const Grain& grain, GrowingLayer& layer) {
  const double doubled = std::clamp(2 * grain.area, -kMostDoubledArea, kMostDoubledArea);
  layer.feature_grains.push_back(
      {grain.axis.from, grain.axis.to, std::llround(doubled), grain.row, grain.born});
  if (!grain.is_covered) layer.grains.push_back(grain);
}

/// Concatenates one array of the histories, and frees it there: so no more than one of them is held
/// twice. `renumber` changes an item from indices of its stock to indices of the layer.
template <class T, class Renumber>
std::vector<T> take_items(std::vector<Stock>& stocks, const std::vector<PartOf>& parts,
                          std::vector<T> History::*items, std::size_t Stock::Part::*begin,
                          const Renumber& renumber) {
  std::size_t size = 0;
  for (const Stock& stock : stocks) size += (stock.history.*items).size();
  std::vector<T> all;
  all.reserve(size);
  for (const PartOf& part : parts) {
    for (T item : items_of(part, items, begin)) {
      renumber(item, part);
      all.push_back(item);
    }
  }
  for (Stock& stock : stocks) stock.history.*items = {};
  return all;
}

/// Throws if the builders hold more together than 32 bits count.
void check_counts(const std::vector<Stock>& stocks) {
  LayerSize size;
  std::size_t grains = 0;
  std::size_t milestones = 0;
  for (const Stock& stock : stocks) {
    const History& history = stock.history;
    size.vertices += history.vertices.size();
    size.edges += history.edges.size();
    milestones += history.milestones.size();
    size.trapezoids += history.trapezoids.size() + history.horizontal_edges.size();
    grains += history.grains.size();
  }
  require_countable(size.vertices, "vertices");
  require_countable(size.edges, "versions of edges");
  require_countable(size.trapezoids, "versions of trapezoids");
  require_countable(milestones, "milestones");
  require_countable(2 * grains, "loops that become dust");
}

/// By row, the number of the graph that the feature is a part of.
void note_graphs(const std::vector<PartOf>& parts, std::vector<std::uint32_t>& graph_of) {
  std::uint32_t graph = 0;
  for (const PartOf& part : parts) {
    for (const std::uint32_t row : items_of(part, &History::rows, &Stock::Part::trapezoids)) {
      if (row >= graph_of.size()) graph_of.resize(row + std::size_t{1});
      graph_of[row] = graph;
    }
    ++graph;
  }
}

/// Of every two features that have a face in common, once for either, however many faces they have.
void note_shared(const FaceFeatures& rows, std::vector<FeatureOverlap>& shared) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const std::vector<std::uint32_t>& features : rows.shared()) {
    for (std::size_t upper = 1; upper < features.size(); ++upper) {
      for (std::size_t lower = 0; lower < upper; ++lower) {
        pairs.emplace_back(features[lower], features[upper]);
      }
    }
  }
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  for (const auto& [lower, upper] : pairs) {
    shared.push_back(FeatureOverlap::in_common(lower, upper));
    shared.push_back(FeatureOverlap::in_common(upper, lower));
  }
}

void concatenate_histories(std::vector<Stock>& stocks, GrowingLayer& layer) {
  using Part = Stock::Part;
  const std::vector<PartOf> parts = in_order_of_rows(stocks);
  const auto as_it_is = [](auto&, const PartOf&) {};
  layer.trapezoids = take_items(stocks, parts, &History::trapezoids, &Part::trapezoids,
                                [](MeshTrapezoid& t, const PartOf& part) {
                                  t.top += part.vertex_shift;
                                  t.bottom += part.vertex_shift;
                                  t.left += part.edge_shift;
                                  t.right += part.edge_shift;
                                });
  note_graphs(parts, layer.graph_of);
  layer.feature_of = take_items(stocks, parts, &History::rows, &Part::trapezoids, as_it_is);
  layer.lifespans = take_items(stocks, parts, &History::lifespans, &Part::trapezoids, as_it_is);
  layer.horizontal_edges =
      take_items(stocks, parts, &History::horizontal_edges, &Part::horizontal_edges,
                 [](HorizontalEdge& horizontal_edge, const PartOf& part) {
                   horizontal_edge.edge += part.edge_shift;
                 });
  for (const Grain& grain : take_items(stocks, parts, &History::grains, &Part::grains, as_it_is)) {
    add_grain(grain, layer);
  }
  layer.edges =
      take_items(stocks, parts, &History::edges, &Part::edges, [](MeshEdge& e, const PartOf& part) {
        e.upper += part.vertex_shift;
        e.lower += part.vertex_shift;
      });
  layer.loop_sizes = take_items(stocks, parts, &History::loop_sizes, &Part::edges, as_it_is);
  layer.milestone_notes =
      take_items(stocks, parts, &History::milestones, &Part::milestones,
                 [](MilestoneNote& note, const PartOf& part) { note.vertex += part.vertex_shift; });
  layer.vertices = take_items(stocks, parts, &History::vertices, &Part::vertices, as_it_is);
}

/// The outlines of all builders in the order of features.
void concatenate_outlines(const std::vector<Stock>& stocks, GrowingLayer& layer) {
  std::vector<std::pair<const Stock*, Stock::Outline>> outlines;
  std::size_t points = 0;
  for (const Stock& stock : stocks) {
    for (const Stock::Outline& outline : stock.outlines) outlines.emplace_back(&stock, outline);
    points += stock.outline_rings.points.size();
  }
  layer.outlines.points.reserve(points);
  std::sort(outlines.begin(), outlines.end(),
            [](const auto& a, const auto& b) { return a.second.row < b.second.row; });
  for (const auto& [stock, outline] : outlines) {
    layer.outline_ends.resize(outline.row, static_cast<std::uint32_t>(layer.outlines.size()));
    for (std::size_t r = outline.begin; r < outline.end; ++r)
      layer.outlines.add(stock->outline_rings[r]);
    layer.outline_ends.push_back(static_cast<std::uint32_t>(layer.outlines.size()));
  }
}

GrowingLayer concatenate(std::vector<Stock> stocks) {
  check_counts(stocks);
  GrowingLayer layer;
  concatenate_histories(stocks, layer);
  concatenate_outlines(stocks, layer);
  for (const Stock& stock : stocks) {
    layer.shared.insert(layer.shared.end(), stock.shared.begin(), stock.shared.end());
  }
  return layer;
}

template <class T>
void permute(std::vector<T>& items, const std::vector<std::uint32_t>& order) {
  std::vector<T> moved;
  moved.reserve(items.size());
  for (const std::uint32_t i : order) moved.push_back(items[i]);
  items.swap(moved);
}

/// The order of the trapezoids in the index.
std::vector<std::uint32_t> order_for_index(const GrowingLayer& layer) {
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
  return order;
}

/// Orders trapezoids for the index.
void order_trapezoids(GrowingLayer& layer) {
  const std::vector<std::uint32_t> order = order_for_index(layer);
  permute(layer.trapezoids, order);
  permute(layer.lifespans, order);
  permute(layer.feature_of, order);
}

/// Growing by doubling would leave much of the room unused.
void add_room_for_trapezoids(std::size_t more, GrowingLayer& layer) {
  layer.trapezoids.reserve(layer.trapezoids.size() + more);
  layer.lifespans.reserve(layer.lifespans.size() + more);
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
  add_room_for_trapezoids(keys.size(), layer);
  layer.feature_of.reserve(layer.feature_of.size() + keys.size());
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
  std::vector<LoopSize> loop_sizes;
  edges.reserve(layer.edges.size());
  loop_sizes.reserve(layer.edges.size());
  const auto edge = [&](std::uint32_t& e) {
    if (number[e] == kUnused) {
      number[e] = static_cast<std::uint32_t>(edges.size());
      edges.push_back(layer.edges[e]);
      loop_sizes.push_back(layer.loop_sizes[e]);
    }
    e = number[e];
  };
  for (MeshTrapezoid& t : layer.trapezoids) {
    edge(t.left);
    edge(t.right);
  }
  layer.edges.swap(edges);
  edges = {};
  layer.loop_sizes.swap(loop_sizes);
  loop_sizes = {};

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
  layer.vertices.swap(vertices);
  vertices = {};
  for (MilestoneNote& note : layer.milestone_notes) note.vertex = number[note.vertex];
}

/// Those of each vertex together, in the order in which they were noted: in that of levels.
void order_milestones(GrowingLayer& layer, LayerContents& to) {
  std::vector<std::uint32_t> ends(layer.vertices.size() + 1, 0);
  for (const MilestoneNote& note : layer.milestone_notes) {
    if (note.vertex != kUnused) ++ends[note.vertex + 1];
  }
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<Milestone> milestones(ends.back());
  std::vector<Level> levels(ends.back());
  for (const MilestoneNote& note : layer.milestone_notes) {
    if (note.vertex == kUnused) continue;
    const std::uint32_t place = ends[note.vertex]++;
    milestones[place] = note.milestone;
    levels[place] = note.level;
  }
  layer.milestone_notes = {};
  // Where those of a vertex began, they end by now.
  ends.pop_back();
  ends.shrink_to_fit();
  to.milestone_ends = std::move(ends);
  to.milestones = std::move(milestones);
  to.milestone_levels = std::move(levels);
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
  require_countable(layer.vertices.size() + 4 * motes.size(), "vertices");
  require_countable(layer.edges.size() + 2 * motes.size(), "versions of edges");
  require_countable(layer.trapezoids.size() + motes.size(), "versions of trapezoids");
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
  add_room_for_trapezoids(motes.size(), layer);
  std::uint32_t singles = 0;
  for (const auto& [is_merged, key, i] : keys) {
    append_mote(motes[i], layer);
    singles += !is_merged;
  }
  return singles;
}

void move_arrays(GrowingLayer& from, LayerContents& to) {
  to.vertices = std::move(from.vertices);
  to.edges = std::move(from.edges);
  to.loop_sizes = std::move(from.loop_sizes);
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
  std::optional<double> most_tolerance;
  WorkShare* share = nullptr;

  void begin_part(std::uint32_t row) {
    const History& history = stock.history;
    stock.parts.push_back({row, history.vertices.size(), history.edges.size(),
                           history.milestones.size(), history.trapezoids.size(),
                           history.horizontal_edges.size(), history.grains.size()});
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

std::optional<double> LayerBuilder::most_tolerance() const {
  return state_->most_tolerance;
}

BuildOutcome LayerBuilder::add(std::uint32_t row, Rings& rings) {
  BuildOutcome outcome = state_->graph_builder.build(rings, state_->graph);
  if (!outcome.built) return outcome;
  if (state_->share != nullptr) state_->share->enter(kGraphShare, 1);
  state_->begin_part(row);
  state_->add_outline(row, rings_of(state_->graph));
  state_->most_tolerance = state_->recorder.record(
      state_->graph, FaceFeatures({row}), state_->options, state_->stock.history, state_->share);
  return outcome;
}

Assembly LayerBuilder::add_coverage(std::span<const std::uint32_t> rows,
                                    std::span<const Rings* const> features, unsigned threads) {
  if (state_->share != nullptr) state_->share->enter(0, kAssemblyShare);
  Assembly assembly = assemble(features, state_->options.coverage, state_->options.close_gaps,
                               state_->coverage_builder, state_->graph, state_->share, threads);
  if (assembly.together.empty()) return assembly;
  state_->begin_part(rows[assembly.together.front()]);
  const FaceFeatures faces = assembly.outcome.faces.named(rows);
  note_shared(faces, state_->stock.shared);
  const std::vector<Rings> outlines = rings_of_features(state_->graph, assembly.outcome.faces);
  for (const std::uint32_t i : assembly.together) state_->add_outline(rows[i], outlines[i]);
  if (state_->share != nullptr) state_->share->enter(kAssemblyShare, 1);
  state_->most_tolerance = state_->recorder.record(state_->graph, faces, state_->options,
                                                   state_->stock.history, state_->share, threads);
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
  std::vector<Stock> stocks;
  for (LayerBuilder& builder : builders) {
    stocks.push_back(std::move(builder.state_->stock));
    builder = LayerBuilder(builder.state_->options);  // what building took is given back
  }
  GrowingLayer arrays = concatenate(std::move(stocks));

  tell(0.2);
  order_trapezoids(arrays);
  tell(0.5);
  const auto polygons = static_cast<std::uint32_t>(arrays.trapezoids.size());
  FeatureOverlaps overlaps = find_overlaps({{0, arrays.vertices, arrays.edges, arrays.trapezoids},
                                            arrays.lifespans,
                                            arrays.feature_of,
                                            arrays.graph_of},
                                           std::move(arrays.shared));
  layer->has_all_overlaps = overlaps.is_complete;
  layer->overlaps = OverlapTable(std::move(overlaps.pairs), arrays.graph_of.size());
  append_horizontal_edges(arrays);
  const auto horizontal_edges = static_cast<std::uint32_t>(arrays.trapezoids.size());
  order_edges_and_vertices(arrays);
  order_milestones(arrays, *layer);
  tell(0.7);
  for (const Point p : arrays.vertices) layer->bounds.include(p);
  layer->size = {arrays.vertices.size(), polygons, arrays.edges.size(), 0};
  const std::uint32_t motes = append_dust(settle(arrays.grains, arrays.vertices.size()), arrays);
  const auto all = static_cast<std::uint32_t>(arrays.trapezoids.size());
  layer->size.motes = all - horizontal_edges;
  sort_for_index(arrays.feature_grains);

  move_arrays(arrays, *layer);
  features.shrink_to_fit();
  layer->features = std::move(features);
  layer->view = MeshView{new_mesh_id(), layer->vertices, layer->edges, layer->trapezoids};
  layer->outline = OutlineView{layer->loop_sizes, layer->milestone_ends, layer->milestones,
                               layer->milestone_levels};
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
