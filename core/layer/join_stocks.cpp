#include "core/layer/join_stocks.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <iterator>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "core/grid/for_each_in_parallel.h"
#include "core/grid/item_count.h"
#include "core/grid/radix_sort.h"
#include "core/layer/dust.h"
#include "core/layer/layer_contents.h"
#include "core/layer/motes_of_grains.h"
#include "core/layer/overlaps.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kUnused = 0xffffffff;
constexpr double kMostDoubledArea = 9e18;  // the limit of 64 bits

/// Calls work(begin, end) for chunks of the items, on up to `threads` threads.
template <typename Work>
void for_each_piece(std::size_t items, unsigned threads, const Work& work) {
  for_each_in_parallel((items + kItemsAtOnce - 1) / kItemsAtOnce, threads, [&](std::size_t piece) {
    const std::size_t begin = piece * kItemsAtOnce;
    work(begin, std::min(begin + kItemsAtOnce, items));
  });
}

/// A part of a builder, with the offsets from indices of its stock to indices of the layer;
/// negative offsets wrap around.
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

/// The parts of all builders in the order of features. Their vertices and edges follow the given
/// numbers of existing ones.
std::vector<PartOf> in_order_of_rows(const std::vector<Stock>& stocks, std::size_t vertices,
                                     std::size_t edges) {
  std::vector<PartOf> parts;
  for (const Stock& stock : stocks) {
    for (std::size_t p = 0; p < stock.parts.size(); ++p) parts.push_back({&stock, p});
  }
  std::sort(parts.begin(), parts.end(), [](const PartOf& a, const PartOf& b) {
    return a.stock->parts[a.part].row < b.stock->parts[b.part].row;
  });
  for (PartOf& part : parts) {
    const Stock::Part& begin = part.stock->parts[part.part];
    part.vertex_shift = static_cast<std::uint32_t>(vertices - begin.vertices);
    part.edge_shift = static_cast<std::uint32_t>(edges - begin.edges);
    vertices += items_of(part, &History::vertices, &Stock::Part::vertices).size();
    edges += items_of(part, &History::edges, &Stock::Part::edges).size();
  }
  return parts;
}

/// Trapezoids in order, with their properties.
struct GrowingMesh {
  std::vector<MeshTrapezoid> trapezoids;
  std::vector<Lifespan> lifespans;
  std::vector<std::uint32_t> feature_of;

  void add(const MeshTrapezoid& trapezoid, Lifespan lifespan, std::uint32_t row) {
    trapezoids.push_back(trapezoid);
    lifespans.push_back(lifespan);
    feature_of.push_back(row);
  }
};

/// The arrays of a layer while they grow. If the layer takes over from an earlier one, vertices and
/// edges begin with all of that one, and the other arrays hold only new content until they are
/// merged.
struct GrowingLayer {
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<LoopSize> loop_sizes;
  std::vector<MilestoneNote> milestone_notes;
  // These replace vertices and edges, see order_edges_and_vertices().
  std::vector<Point> ordered_vertices;
  std::vector<MeshEdge> ordered_edges;
  GrowingMesh mesh;
  GrowingMesh horizontal_edges;  // each as a trapezoid without height whose sides are both the edge
  Rings outlines;
  std::vector<std::uint32_t> outline_ends;
  std::vector<std::uint32_t> graph_of;  // by row: the first row of its graph
  std::vector<FeatureOverlap> known;    // between features that are not compared
};

FeatureGrain stored_grain(const Grain& grain) {
  const double doubled = std::clamp(2 * grain.area, -kMostDoubledArea, kMostDoubledArea);
  return {grain.axis.from, grain.axis.to, std::llround(doubled),
          grain.row,       grain.born,    grain.is_covered};
}

/// Appends one array of the histories to the existing items and frees it there, so that no more
/// than one of them is held twice. `renumber` converts an item from indices of its stock to indices
/// of the layer.
template <class T, class Renumber>
std::vector<T> take_items(std::vector<Stock>& stocks, const std::vector<PartOf>& parts,
                          std::vector<T> History::*items, std::size_t Stock::Part::*begin,
                          const Renumber& renumber, std::span<const T> before = {}) {
  std::size_t size = before.size();
  for (const Stock& stock : stocks) size += (stock.history.*items).size();
  std::vector<T> all;
  all.reserve(size);
  all.assign(before.begin(), before.end());
  for (const PartOf& part : parts) {
    for (T item : items_of(part, items, begin)) {
      renumber(item, part);
      all.push_back(item);
    }
  }
  for (Stock& stock : stocks) stock.history.*items = {};
  return all;
}

/// Throws if the total number of items of any kind exceeds what 32 bits can count.
void check_counts(const std::vector<Stock>& stocks, const LayerArrays& earlier) {
  LayerSize size;
  size.vertices = earlier.vertices.size();
  size.edges = earlier.edges.size();
  size.trapezoids = earlier.trapezoids.size();
  std::size_t grains = earlier.grains.size();
  std::size_t milestones = earlier.outline.milestones.size();
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

/// By row: the first row of the graph to which the feature belongs.
void note_graphs(const std::vector<PartOf>& parts, const TakenOver& taken,
                 std::vector<std::uint32_t>& graph_of) {
  const auto note = [&graph_of](std::uint32_t row, std::uint32_t graph) {
    if (row >= graph_of.size()) graph_of.resize(row + std::size_t{1});
    graph_of[row] = graph;
  };
  for (const PartOf& part : parts) {
    const std::uint32_t graph = part.stock->parts[part.part].row;
    for (const std::uint32_t row : items_of(part, &History::rows, &Stock::Part::trapezoids)) {
      note(row, graph);
    }
  }
  for (const TakenRow& row : taken.rows()) note(row.row, row.first);
}

std::vector<FeatureGrain> take_grains(std::vector<Stock>& stocks,
                                      const std::vector<PartOf>& parts) {
  std::vector<FeatureGrain> grains;
  const auto as_it_is = [](auto&, const PartOf&) {};
  for (const Grain& grain :
       take_items(stocks, parts, &History::grains, &Stock::Part::grains, as_it_is)) {
    grains.push_back(stored_grain(grain));
  }
  return grains;
}

/// Starts with the items of the earlier layer, including dust; unused ones are removed later.
void begin_with(const LayerArrays& earlier, GrowingLayer& layer) {
  const OutlineView& outline = earlier.outline;
  layer.loop_sizes.assign(outline.loop_sizes.begin(), outline.loop_sizes.end());
  layer.loop_sizes.resize(earlier.edges.size());
  layer.milestone_notes.reserve(outline.milestones.size());
  std::uint32_t begin = 0;
  for (std::uint32_t vertex = 0; vertex < outline.milestone_ends.size(); ++vertex) {
    const std::uint32_t end = std::max(begin, outline.milestone_ends[vertex]);
    for (; begin < end; ++begin) {
      layer.milestone_notes.push_back(
          {vertex, outline.milestones[begin], outline.milestone_levels[begin]});
    }
  }
}

void concatenate_histories(std::vector<Stock>& stocks, const std::vector<PartOf>& parts,
                           const LayerArrays& earlier, GrowingLayer& layer) {
  using Part = Stock::Part;
  const auto as_it_is = [](auto&, const PartOf&) {};
  layer.mesh.trapezoids = take_items(stocks, parts, &History::trapezoids, &Part::trapezoids,
                                     [](MeshTrapezoid& t, const PartOf& part) {
                                       t.top += part.vertex_shift;
                                       t.bottom += part.vertex_shift;
                                       t.left += part.edge_shift;
                                       t.right += part.edge_shift;
                                     });
  layer.mesh.feature_of = take_items(stocks, parts, &History::rows, &Part::trapezoids, as_it_is);
  layer.mesh.lifespans =
      take_items(stocks, parts, &History::lifespans, &Part::trapezoids, as_it_is);
  layer.edges = take_items(
      stocks, parts, &History::edges, &Part::edges,
      [](MeshEdge& e, const PartOf& part) {
        e.upper += part.vertex_shift;
        e.lower += part.vertex_shift;
      },
      earlier.edges);
  begin_with(earlier, layer);
  layer.loop_sizes = take_items(stocks, parts, &History::loop_sizes, &Part::edges, as_it_is,
                                std::span<const LoopSize>(layer.loop_sizes));
  layer.milestone_notes = take_items(
      stocks, parts, &History::milestones, &Part::milestones,
      [](MilestoneNote& note, const PartOf& part) { note.vertex += part.vertex_shift; },
      std::span<const MilestoneNote>(layer.milestone_notes));
  layer.vertices =
      take_items(stocks, parts, &History::vertices, &Part::vertices, as_it_is, earlier.vertices);
  const std::vector<HorizontalEdge> horizontal_edges =
      take_items(stocks, parts, &History::horizontal_edges, &Part::horizontal_edges,
                 [](HorizontalEdge& horizontal_edge, const PartOf& part) {
                   horizontal_edge.edge += part.edge_shift;
                 });
  for (const HorizontalEdge& it : horizontal_edges) {
    const MeshEdge& edge = layer.edges[it.edge];
    layer.horizontal_edges.add({edge.upper, edge.lower, it.edge, it.edge}, it.lifespan, it.row);
  }
}

/// The outlines of all builders and those taken over, in the order of features.
void concatenate_outlines(const std::vector<Stock>& stocks, const TakenOver& taken,
                          GrowingLayer& layer) {
  struct Source {
    std::uint32_t row;
    std::uint32_t earlier_row;
    const Stock* stock;  // null if the feature is taken over
    const Stock::Outline* outline;
  };
  std::vector<Source> sources;
  std::size_t points = 0;
  for (const Stock& stock : stocks) {
    for (const Stock::Outline& outline : stock.outlines) {
      sources.push_back({outline.row, 0, &stock, &outline});
    }
    points += stock.outline_rings.points.size();
  }
  for (const TakenRow& row : taken.rows()) {
    sources.push_back({row.row, row.earlier, nullptr, nullptr});
  }
  if (!taken.empty()) points += taken.earlier().arrays().outline_points.size();
  layer.outlines.points.reserve(points);
  std::ranges::sort(sources, {}, &Source::row);
  for (const Source& source : sources) {
    layer.outline_ends.resize(source.row, static_cast<std::uint32_t>(layer.outlines.size()));
    if (source.stock == nullptr) {
      taken.earlier().layer().append_outline(source.earlier_row, layer.outlines);
    } else {
      for (std::size_t r = source.outline->begin; r < source.outline->end; ++r)
        layer.outlines.add(source.stock->outline_rings[r]);
    }
    layer.outline_ends.push_back(static_cast<std::uint32_t>(layer.outlines.size()));
  }
}

/// By row: the bounding box of the feature.
std::vector<Box> boxes_of(const GrowingLayer& layer) {
  std::vector<Box> boxes(layer.graph_of.size());
  std::size_t ring = 0;
  for (std::size_t row = 0; row < std::min(boxes.size(), layer.outline_ends.size()); ++row) {
    for (; ring < layer.outline_ends[row]; ++ring) {
      for (const Point p : layer.outlines[ring]) boxes[row].include(p);
    }
  }
  return boxes;
}

/// Whether the overlaps between features taken over are known. Because of rounding, their extent
/// depends on which feature of a pair is examined first.
bool are_overlaps_known(const TakenOver& taken) {
  return !taken.empty() && taken.earlier().layer().has_all_overlaps() && taken.keeps_order();
}

/// The pairs of features that are both taken over: those that share a face, or all.
void take_overlaps(const TakenOver& taken, bool all, std::vector<FeatureOverlap>& overlaps) {
  if (taken.empty()) return;
  if (!all && !taken.earlier().layer().overlaps().are_any_in_common()) return;
  for (FeatureOverlap pair : taken.earlier().arrays().overlaps) {
    pair.row = taken.row_now(pair.row);
    pair.other = taken.row_now(pair.other);
    const bool is_taken = pair.row != TakenOver::kNotTaken && pair.other != TakenOver::kNotTaken;
    if (is_taken && (all || pair.is_in_common())) overlaps.push_back(pair);
  }
}

/// By row: features of the same kind are not compared with each other. These are the features of
/// one graph, and all features taken over if the overlaps between them are known.
std::vector<std::uint32_t> kinds_to_compare(const TakenOver& taken, bool are_known,
                                            const std::vector<std::uint32_t>& graph_of) {
  std::vector<std::uint32_t> kinds = graph_of;
  if (!are_known) return kinds;
  for (const TakenRow& row : taken.rows()) kinds[row.row] = kUnused;
  return kinds;
}

/// The dust of a layer.
struct Dust {
  std::vector<FeatureGrain> grains;  // in order for the index
  std::vector<Mote> motes;
};

/// The order of `count` items by key, then by index.
template <typename KeyOf>
LargeArray<KeyedIndex> order_by(std::size_t count, const KeyOf& key_of, unsigned threads) {
  LargeArray<KeyedIndex> order(count);
  for_each_piece(count, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) order[i] = {key_of(i), static_cast<std::uint32_t>(i)};
  });
  LargeArray<KeyedIndex> scratch;
  sort_by_key(order, scratch, threads);
  return order;
}

/// The order of new trapezoids, or horizontal edges, for the index.
LargeArray<KeyedIndex> order_for_index(const GrowingMesh& mesh, const MeshView& view,
                                       unsigned threads) {
  const auto key_of = [&](std::size_t i) {
    return order_key(box_of(view, mesh.trapezoids[i]), mesh.lifespans[i]);
  };
  return order_by(mesh.trapezoids.size(), key_of, threads);
}

/// A run in an ordered array: items of the earlier layer, of which those not taken over must be
/// left out, or one new item.
struct Run {
  std::size_t begin = 0;
  std::size_t end = 0;
  bool is_fresh = false;
};

/// Adds the new items, in that order, and those trapezoids of the earlier layer within `range` (the
/// second bound is excluded) that are taken over.
void add_in_order(const TakenOver& taken, std::pair<std::size_t, std::size_t> range,
                  const GrowingMesh& fresh, const LargeArray<KeyedIndex>& order,
                  const std::vector<std::uint32_t>& graph_of, GrowingMesh& mesh, unsigned threads) {
  const LayerArrays earlier = taken.empty() ? LayerArrays() : taken.earlier().arrays();
  std::vector<Run> runs;
  if (!taken.empty()) {
    const MeshView view = taken.earlier().layer().mesh();
    std::vector<OrderPlace> places;
    places.reserve(order.size());
    for (const KeyedIndex& item : order) {
      places.push_back({item.key, graph_of[fresh.feature_of[item.index]]});
    }
    taken.merge(
        range,
        [&](std::size_t i) {
          return order_key(box_of(view, earlier.trapezoids[i]), earlier.lifespans[i]);
        },
        [&](std::size_t i) { return earlier.feature_of[i]; }, places,
        [&](std::size_t begin, std::size_t end) {
          runs.push_back({begin, end, false});
        },
        [&](std::size_t k) {
          runs.push_back({order[k].index, order[k].index + 1, true});
        },
        threads);
  }
  const auto add_runs = [&](const auto& of_earlier, const auto& of_fresh, auto& to,
                            const auto& changed) {
    if (taken.empty()) {
      for (const KeyedIndex& item : order) to.push_back(of_fresh[item.index]);
      return;
    }
    for (const Run& run : runs) {
      if (run.is_fresh) {
        to.push_back(of_fresh[run.begin]);
        continue;
      }
      for (std::size_t i = run.begin; i < run.end; ++i) {
        const std::uint32_t row = taken.row_now(earlier.feature_of[i]);
        if (row != TakenOver::kNotTaken) to.push_back(changed(of_earlier[i], row));
      }
    }
  };
  const auto as_it_is = [](const auto& item, std::uint32_t) { return item; };
  for_each_in_parallel(2, threads, [&](std::size_t i) {
    if (i == 0) return add_runs(earlier.trapezoids, fresh.trapezoids, mesh.trapezoids, as_it_is);
    add_runs(earlier.lifespans, fresh.lifespans, mesh.lifespans, as_it_is);
    add_runs(earlier.feature_of, fresh.feature_of, mesh.feature_of,
             [](std::uint32_t, std::uint32_t row) { return row; });
  });
}

std::size_t count_taken(const TakenOver& taken, unsigned threads) {
  if (taken.empty()) return 0;
  const std::span<const std::uint32_t> rows = taken.earlier().arrays().feature_of;
  std::atomic<std::size_t> count = 0;
  for_each_piece(rows.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::size_t here = 0;
    for (const std::uint32_t row : rows.subspan(begin, end - begin)) {
      here += taken.row_now(row) != TakenOver::kNotTaken;
    }
    count += here;
  });
  return count;
}

/// Puts trapezoids, including those taken over, in order for the index, followed by the horizontal
/// edges, with room for so many motes. Returns the number of trapezoids.
std::uint32_t order_mesh(const TakenOver& taken, std::size_t motes, GrowingLayer& layer,
                         unsigned threads) {
  const GrowingMesh fresh = std::exchange(layer.mesh, {});
  const GrowingMesh edges = std::exchange(layer.horizontal_edges, {});
  const MeshView view{0, layer.vertices, layer.edges, {}};
  const LargeArray<KeyedIndex> order = order_for_index(fresh, view, threads);
  const LargeArray<KeyedIndex> edge_order = order_for_index(edges, view, threads);
  std::size_t all = 0;
  std::size_t polygons = 0;
  if (!taken.empty()) {
    all = taken.earlier().arrays().feature_of.size();
    polygons = all - taken.earlier().arrays().horizontal_edges;
  }
  GrowingMesh& mesh = layer.mesh;
  const std::size_t count = count_taken(taken, threads) + order.size() + edge_order.size();
  mesh.trapezoids.reserve(count + motes);
  mesh.lifespans.reserve(count + motes);
  mesh.feature_of.reserve(count);
  add_in_order(taken, {0, polygons}, fresh, order, layer.graph_of, mesh, threads);
  const auto trapezoids = static_cast<std::uint32_t>(mesh.trapezoids.size());
  add_in_order(taken, {polygons, all}, edges, edge_order, layer.graph_of, mesh, threads);
  // In a truncated file there may be more than were counted.
  mesh.trapezoids.reserve(mesh.trapezoids.size() + motes);
  mesh.lifespans.reserve(mesh.lifespans.size() + motes);
  return trapezoids;
}

/// Puts grains, including those taken over, in order for the index.
void order_grains(const TakenOver& taken, const std::vector<std::uint32_t>& graph_of,
                  std::vector<FeatureGrain>& grains) {
  const LargeArray<KeyedIndex> order = order_by(
      grains.size(), [&](std::size_t i) { return order_key(grains[i]); }, 1);
  std::vector<FeatureGrain> ordered;
  std::vector<OrderPlace> places;
  const std::span<const FeatureGrain> earlier =
      taken.empty() ? std::span<const FeatureGrain>() : taken.earlier().arrays().grains;
  ordered.reserve(grains.size() + earlier.size());
  if (taken.empty()) {
    for (const KeyedIndex& item : order) ordered.push_back(grains[item.index]);
    return grains.swap(ordered);
  }
  places.reserve(order.size());
  for (const KeyedIndex& item : order) {
    places.push_back({item.key, graph_of[grains[item.index].row]});
  }
  const auto take = [&](std::size_t begin, std::size_t end) {
    for (FeatureGrain grain : earlier.subspan(begin, end - begin)) {
      grain.row = taken.row_now(grain.row);
      if (grain.row != TakenOver::kNotTaken) ordered.push_back(grain);
    }
  };
  taken.merge(
      {0, earlier.size()}, [&](std::size_t i) { return order_key(earlier[i]); },
      [&](std::size_t i) { return earlier[i].row; }, places, take,
      [&](std::size_t k) { ordered.push_back(grains[order[k].index]); }, 1);
  grains.swap(ordered);
}

/// New numbers of edges and vertices, in the order in which the trapezoids use them, so that items
/// drawn together are near each other in memory; kUnused for those that are removed.
struct Numbering {
  std::vector<std::uint32_t> edges;
  std::vector<std::uint32_t> vertices;
};

/// Renumbers edges and vertices; the trapezoids are not changed. Reserves room for so many motes
/// after them.
Numbering order_edges_and_vertices(std::size_t motes, GrowingLayer& layer) {
  Numbering number;
  number.edges.assign(layer.edges.size(), kUnused);
  std::vector<MeshEdge> edges;
  std::vector<LoopSize> loop_sizes;
  edges.reserve(layer.edges.size() + 2 * motes);
  loop_sizes.reserve(layer.edges.size());
  const auto edge = [&](std::uint32_t e) {
    if (number.edges[e] != kUnused) return;
    number.edges[e] = static_cast<std::uint32_t>(edges.size());
    edges.push_back(layer.edges[e]);
    loop_sizes.push_back(layer.loop_sizes[e]);
  };
  for (const MeshTrapezoid& t : layer.mesh.trapezoids) {
    edge(t.left);
    edge(t.right);
  }
  layer.loop_sizes.swap(loop_sizes);

  number.vertices.assign(layer.vertices.size(), kUnused);
  std::vector<Point> vertices;
  vertices.reserve(layer.vertices.size() + 4 * motes);
  const auto vertex = [&](std::uint32_t v) {
    if (number.vertices[v] == kUnused) {
      number.vertices[v] = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back(layer.vertices[v]);
    }
    return number.vertices[v];
  };
  for (MeshEdge& e : edges) {
    e.upper = vertex(e.upper);
    e.lower = vertex(e.lower);
  }
  for (const MeshTrapezoid& t : layer.mesh.trapezoids) {
    vertex(t.top);
    vertex(t.bottom);
  }
  layer.ordered_edges = std::move(edges);
  layer.ordered_vertices = std::move(vertices);
  for (MilestoneNote& note : layer.milestone_notes) note.vertex = number.vertices[note.vertex];
  return number;
}

/// Replaces the edges and vertices by the ordered ones.
void renumber(const Numbering& number, GrowingLayer& layer, unsigned threads) {
  layer.edges = std::move(layer.ordered_edges);
  layer.vertices = std::move(layer.ordered_vertices);
  for_each_piece(layer.mesh.trapezoids.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      MeshTrapezoid& t = layer.mesh.trapezoids[i];
      t = {number.vertices[t.top], number.vertices[t.bottom], number.edges[t.left],
           number.edges[t.right]};
    }
  });
}

/// Groups milestones by vertex, in the order in which they were noted, which is that of levels.
void order_milestones(GrowingLayer& layer, LayerContents& to) {
  std::vector<std::uint32_t> ends(layer.ordered_vertices.size() + 1, 0);
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
  // The begin of each vertex has advanced to its end.
  ends.pop_back();
  ends.shrink_to_fit();
  to.milestone_ends = std::move(ends);
  to.milestones = std::move(milestones);
  to.milestone_levels = std::move(levels);
}

/// Single motes first, then merged ones; returns the number of single ones.
std::uint32_t append_dust(const std::vector<Mote>& motes, GrowingLayer& layer, unsigned threads) {
  require_countable(layer.vertices.size() + 4 * motes.size(), "vertices");
  require_countable(layer.edges.size() + 2 * motes.size(), "versions of edges");
  require_countable(layer.mesh.trapezoids.size() + motes.size(), "versions of trapezoids");
  const LargeArray<KeyedIndex> order = order_by(
      motes.size(), [&](std::size_t i) { return order_key(motes[i]); }, threads);
  std::uint32_t singles = 0;
  for (const bool is_merged : {false, true}) {
    for (const KeyedIndex& item : order) {
      const Mote& mote = motes[item.index];
      if (mote.is_merged != is_merged) continue;
      append_mote(mote, layer.vertices, layer.edges, layer.mesh.trapezoids);
      layer.mesh.lifespans.push_back(mote.lifespan);
      singles += !is_merged;
    }
  }
  return singles;
}

void move_arrays(GrowingLayer& from, LayerContents& to) {
  to.vertices = std::move(from.vertices);
  to.edges = std::move(from.edges);
  to.loop_sizes = std::move(from.loop_sizes);
  to.trapezoids = std::move(from.mesh.trapezoids);
  to.lifespans = std::move(from.mesh.lifespans);
  to.feature_of = std::move(from.mesh.feature_of);
  to.outline_points = std::move(from.outlines.points);
  to.ring_ends = std::move(from.outlines.ends);
  to.outline_ends = std::move(from.outline_ends);
}

/// The units of all builders in the order of features.
void move_units(const std::vector<Stock>& stocks, LayerContents& layer) {
  std::vector<FeatureUnit> features;
  std::vector<std::tuple<std::uint32_t, const BuiltUnits*, std::size_t>> order;
  for (const Stock& stock : stocks) {
    const BuiltUnits& units = stock.units;
    features.insert(features.end(), units.features.begin(), units.features.end());
    for (std::size_t g = 0; g < units.groups.size(); ++g) {
      order.emplace_back(units.view().members_of(g).front().row, &units, g);
    }
  }
  std::ranges::sort(features, {}, &FeatureUnit::row);
  std::ranges::sort(order, {}, [](const auto& item) { return std::get<0>(item); });
  BuiltUnits all;
  for (const auto& [row, units, g] : order) {
    const auto members = units->view().members_of(g);
    const auto overlaps = units->view().overlaps_of(g);
    all.members.insert(all.members.end(), members.begin(), members.end());
    all.overlaps.insert(all.overlaps.end(), overlaps.begin(), overlaps.end());
    all.groups.push_back(units->groups[g]);
    all.groups.back().members_end = static_cast<std::uint32_t>(all.members.size());
    all.groups.back().overlaps_end = static_cast<std::uint32_t>(all.overlaps.size());
  }
  layer.feature_units = std::move(features);
  layer.group_units = std::move(all.groups);
  layer.group_members = std::move(all.members);
  layer.group_overlaps = std::move(all.overlaps);
}

/// Everything that the builders take over. Features with the same rings could each have received
/// the history of any of them: here they get them in order, so that an order that was kept so far
/// stays so.
TakenOver take_over(const std::vector<Stock>& stocks, const EarlierLayer* earlier) {
  std::vector<TakenRow> rows;
  std::vector<Stock::Double> doubles;
  for (const Stock& stock : stocks) {
    rows.insert(rows.end(), stock.taken.begin(), stock.taken.end());
    doubles.insert(doubles.end(), stock.doubles.begin(), stock.doubles.end());
  }
  std::vector<Stock::Double> in_order = doubles;
  std::ranges::sort(doubles, {}, [](const auto& d) { return std::pair(d.digest, d.row.row); });
  std::ranges::sort(in_order, {}, [](const auto& d) { return std::pair(d.digest, d.row.earlier); });
  for (std::size_t i = 0; i < doubles.size(); ++i) {
    rows.push_back(doubles[i].row);
    rows.back().earlier = in_order[i].row.earlier;
  }
  if (rows.empty()) return {};
  return {*earlier, std::move(rows)};
}

}  // namespace

std::unique_ptr<Layer> join_stocks(std::vector<Stock> stocks, const EarlierLayer* earlier,
                                   const LayerOptions& options, FeatureTable features,
                                   const std::function<void(double)>& progress, unsigned threads) {
  const auto tell = [&progress](double share) {
    if (progress) progress(share);
  };
  auto layer = std::make_unique<LayerContents>();
  layer->options = options;
  move_units(stocks, *layer);
  const TakenOver taken = take_over(stocks, earlier);
  const LayerArrays before = taken.empty() ? LayerArrays() : earlier->arrays();
  check_counts(stocks, before);
  const std::vector<PartOf> parts =
      in_order_of_rows(stocks, before.vertices.size(), before.edges.size());
  GrowingLayer arrays;
  note_graphs(parts, taken, arrays.graph_of);
  const auto launch = threads > 1 ? std::launch::async : std::launch::deferred;
  // In the order of the grains, so that sums do not depend on who built what.
  std::future<Dust> settling = std::async(launch, [&, grains = take_grains(stocks, parts),
                                                   vertices = layer->count_vertices()]() mutable {
    order_grains(taken, arrays.graph_of, grains);
    std::vector<Mote> motes = settle(uncovered(grains), vertices);
    return Dust{std::move(grains), std::move(motes)};
  });
  for_each_in_parallel(2, threads, [&](std::size_t i) {
    if (i == 0) concatenate_histories(stocks, parts, before, arrays);
    if (i == 1) concatenate_outlines(stocks, taken, arrays);
  });
  for (const Stock& stock : stocks) {
    arrays.known.insert(arrays.known.end(), stock.shared.begin(), stock.shared.end());
  }
  const bool are_known = are_overlaps_known(taken);
  take_overlaps(taken, are_known, arrays.known);
  stocks.clear();

  tell(0.2);
  Dust dust = settling.get();
  const std::uint32_t polygons = order_mesh(taken, dust.motes.size(), arrays, threads);
  const auto horizontal_edges = static_cast<std::uint32_t>(arrays.mesh.trapezoids.size());
  tell(0.5);
  const std::vector<Box> boxes = boxes_of(arrays);
  const std::vector<std::uint32_t> kinds = kinds_to_compare(taken, are_known, arrays.graph_of);
  std::future<FeatureOverlaps> finding = std::async(launch, [&] {
    const MeshView mesh{0, arrays.vertices, arrays.edges, arrays.mesh.trapezoids};
    const GrowingMesh& all = arrays.mesh;
    const auto find = [&](std::span<const std::uint32_t> kinds_of_rows,
                          std::vector<FeatureOverlap> known) {
      return find_overlaps({mesh, std::span(all.lifespans).first(polygons),
                            std::span(all.feature_of).first(polygons), kinds_of_rows, boxes},
                           std::move(known), threads);
    };
    if (!are_known) return find(kinds, std::move(arrays.known));
    std::vector<FeatureOverlap> in_common;
    std::ranges::copy_if(arrays.known, std::back_inserter(in_common),
                         &FeatureOverlap::is_in_common);
    FeatureOverlaps found = find(kinds, std::move(arrays.known));
    if (found.is_complete) return found;
    // If nothing were taken over, they would not all be found, so the known ones are not kept.
    return find(arrays.graph_of, std::move(in_common));
  });
  const Numbering number = order_edges_and_vertices(dust.motes.size(), arrays);
  order_milestones(arrays, *layer);
  for (const Point p : arrays.ordered_vertices) layer->bounds.include(p);
  FeatureOverlaps overlaps = finding.get();
  layer->has_all_overlaps = overlaps.is_complete;
  layer->overlaps = OverlapTable(std::move(overlaps.pairs), arrays.graph_of.size());
  tell(0.6);
  renumber(number, arrays, threads);
  layer->size = {arrays.vertices.size(), polygons, arrays.edges.size(), 0};
  const std::uint32_t motes = append_dust(dust.motes, arrays, threads);
  const auto all = static_cast<std::uint32_t>(arrays.mesh.trapezoids.size());
  layer->size.motes = all - horizontal_edges;
  tell(0.7);

  move_arrays(arrays, *layer);
  features.shrink_to_fit();
  layer->features = std::move(features);
  layer->view = MeshView{new_mesh_id(), layer->vertices, layer->edges, layer->trapezoids};
  layer->outline = OutlineView{layer->loop_sizes, layer->milestone_ends, layer->milestones,
                               layer->milestone_levels};
  const auto index = [&layer, threads](std::uint32_t from, std::uint32_t to) {
    return MeshIndex(layer->view, {from, to - from}, layer->lifespans, threads);
  };
  tell(0.8);
  layer->segments.push_back(std::make_shared<const MeshSegment>(MeshSegment{
      index(0, polygons), index(polygons, horizontal_edges),
      index(horizontal_edges, horizontal_edges + motes), index(horizontal_edges + motes, all)}));
  layer->grains = GrainIndex(std::move(dust.grains));
  return std::make_unique<Layer>(std::move(layer));
}

}  // namespace trapeze
