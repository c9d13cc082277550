#include "core/adapt/history_recorder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "core/adapt/batch_removal.h"
#include "core/adapt/loop_sizes.h"
#include "core/grid/for_each_in_parallel.h"
#include "core/grid/item_count.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kNoVersion = 0xffffffff;
constexpr std::uint64_t kRemovalsBetweenShares = 1024;
constexpr std::uint32_t kHorizontalBit = 0x80000000;
constexpr std::size_t kMostVersions = kHorizontalBit - 1;  // of nodes: one bit is a flag

/// Equal, except that top or bottom may be another vertex of the same y.
bool covers_the_same(const History& history, const MeshTrapezoid& a, const MeshTrapezoid& b) {
  const auto y = [&history](std::uint32_t vertex) { return history.vertices[vertex].y; };
  return a.left == b.left && a.right == b.right && y(a.top) == y(b.top) &&
         y(a.bottom) == y(b.bottom);
}

bool has_height(const History& history, const MeshTrapezoid& t) {
  return history.vertices[t.top].y != history.vertices[t.bottom].y;
}

/// The horizontal side of a trapezoid without height, if it has one.
std::optional<std::uint32_t> horizontal_edge_of(const History& history, const MeshTrapezoid& t) {
  for (const std::uint32_t side : {t.left, t.right}) {
    const MeshEdge& edge = history.edges[side];
    if (history.vertices[edge.upper].y == history.vertices[edge.lower].y) return side;
  }
  return std::nullopt;
}

Lifespan& lifespan_of(History& history, std::uint32_t version) {
  return (version & kHorizontalBit) == 0
             ? history.lifespans[version]
             : history.horizontal_edges[version ^ kHorizontalBit].lifespan;
}

/// Whether one of the levels from `level` up to, but not including, `next` is the tolerance of a
/// whole zoom.
bool reaches_tolerance_of_zoom(int level, int next) {
  return level % kLevelsPerOctave == 1 || next - level >= kLevelsPerOctave;
}

/// Puts the flagged ids in ascending order, in which neighbours are near each other in memory. The
/// order in which they were touched is that of weights, which is scattered over the map, and of
/// threads.
template <class IdType>
void put_in_order(std::vector<IdType>& ids, const Table<IdType, std::uint8_t>& flags) {
  constexpr std::size_t kSparse = 16;
  if (ids.size() < flags.size() / kSparse) {
    std::sort(ids.begin(), ids.end());
    return;
  }
  ids.clear();
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (flags[IdType(i)] != 0) ids.push_back(IdType(i));
  }
}

}  // namespace

std::uint64_t HistoryRecorder::most_work(std::size_t vertices) {
  constexpr std::uint64_t kAlways = std::uint64_t{1} << 27;
  constexpr std::uint64_t kPerVertexAndDoubling =
      48;  // outlines of any size take 12 to 16 per vertex
  return kAlways + kPerVertexAndDoubling * vertices * std::bit_width(vertices);
}

std::optional<double> HistoryRecorder::record(TrapezoidalGraph& graph, const FaceFeatures& rows,
                                              const GeneralizationOptions& options,
                                              History& history, WorkShare* share, unsigned threads,
                                              const MergePlan* plan) {
  rows_ = &rows;
  for_each_in_parallel(2, threads, [&](std::size_t i) {
    if (i == 0) stack_.assign(graph, options, threads, plan);
    if (i == 1) begin(graph, history);
  });
  milestones_.begin(graph, stack_);
  milestones_.note(0, vertex_base_, history.milestones);
  EditLog log(graph);
  BatchRemoval batch(stack_, graph, threads);
  touched_by_lane_.assign(batch.lanes(), {});
  const auto vertices = static_cast<double>(graph.vertex_count());
  const std::uint64_t most = most_work(graph.vertex_count());
  int level = 0;
  double reached = 0;
  for (;;) {
    if (level > 0) remove_batch(batch, static_cast<Level>(level));
    const bool is_spent = stack_.counts().touched + stack_.counts().walked > most;
    const std::optional<double> epsilon = is_spent ? std::nullopt : stack_.remove_next(graph, log);
    const int next = epsilon ? level_above(*epsilon) : kLastLevel + 1;
    if (next != level) {
      // All removals so far were due at `level`; the last edit is due only at `next`.
      if (epsilon) log.revert();
      const bool is_noted = reaches_tolerance_of_zoom(level, next);
      for_each_in_parallel(is_noted ? 2 : 1, threads, [&](std::size_t i) {
        if (i == 0 && level > 0) end_level(graph, static_cast<Level>(level));
        if (i == 1) milestones_.note(static_cast<Level>(level), vertex_base_, history.milestones);
      });
      if (next > kLastLevel) return is_spent ? std::optional(reached) : std::nullopt;
      log.apply();
      level = next;
    }
    reached = epsilon.value_or(reached);
    note_touched(log, touched_);
    if (stack_.last_removal() == Removal::region) touch_along(graph, log);
    note_lost_area(graph, static_cast<Level>(level));
    log.forget();
    const std::uint64_t removals = stack_.counts().removals;
    if (share != nullptr && removals % kRemovalsBetweenShares == 0) {
      share->tell(static_cast<double>(removals) / vertices);
    }
  }
}

std::optional<double> HistoryRecorder::record(TrapezoidalGraph& graph,
                                              const GeneralizationOptions& options,
                                              History& history) {
  return record(graph, FaceFeatures({0}), options, history);
}

void HistoryRecorder::begin(const TrapezoidalGraph& graph, History& history) {
  history_ = &history;
  vertex_base_ = static_cast<std::uint32_t>(history.vertices.size());
  for (std::size_t v = 1; v <= graph.vertex_count(); ++v) {
    history.vertices.push_back(graph.point(VertexId(v)));
  }
  require_countable(history.vertices.size(), "vertices");
  edge_version_.assign(graph.edges().size(), kNoVersion);
  node_version_.assign(graph.nodes().size(), kNoVersion);
  touched_.edges.clear();
  touched_.nodes.clear();
  edge_is_touched_.assign(graph.edges().size(), 0);
  node_is_touched_.assign(graph.nodes().size(), 0);
  measure_loop_sizes(graph, *rows_, loop_sizes_);
  for (std::size_t e = 0; e < graph.edges().size(); ++e) {
    const EdgeId edge(e);
    if (!graph.is_frame(edge) && has_features_beside(graph.edge(edge))) open_edge(graph, edge);
  }
  for (std::size_t n = 0; n < graph.nodes().size(); ++n) renew_node(graph, NodeId(n), 0);
  if (!graph.is_coverage()) measure_loops(graph);
}

void HistoryRecorder::measure_loops(const TrapezoidalGraph& graph) {
  loops_.clear();
  loop_of_.assign(graph.corners().size(), kNoVersion);
  for (std::size_t i = 0; i < graph.corners().size(); ++i) {
    if (loop_of_[CornerId(i)] != kNoVersion) continue;
    // Doubled area, positive if the loop runs clockwise on the map.
    Int128 doubled = 0;
    BoundaryMoments moments(graph.point(graph.corner(CornerId(i)).vertex));
    CornerId c(i);
    do {
      loop_of_[c] = static_cast<std::uint32_t>(loops_.size());
      const Corner& corner = graph.corner(c);
      const Point a = graph.point(corner.vertex);
      const Point b = graph.point(graph.corner(corner.next).vertex);
      doubled += static_cast<Int128>(a.x) * b.y - static_cast<Int128>(b.x) * a.y;
      moments.add(a, b);
      c = corner.next;
    } while (c != CornerId(i));
    // The inside of a clockwise loop is left of an edge that leads down and right of one that leads
    // up.
    const Corner& first = graph.corner(CornerId(i));
    const bool goes_down = first.vertex == graph.edge(first.edge).end[kUp];
    const bool clockwise = doubled > 0;
    const Side own = goes_down == clockwise ? kLeft : kRight;
    loops_.push_back({moments.sum().axis(), std::abs(static_cast<double>(doubled)) / 2,
                      graph.edge(first.edge).face[own] == kOutside});
  }
}

void HistoryRecorder::touch(NodeId n, Touched& touched) {
  if (node_is_touched_[n] != 0) return;
  node_is_touched_[n] = 1;
  touched.nodes.push_back(n);
}

void HistoryRecorder::touch(EdgeId e, Touched& touched) {
  if (edge_is_touched_[e] != 0) return;
  edge_is_touched_[e] = 1;
  touched.edges.push_back(e);
}

void HistoryRecorder::remove_batch(BatchRemoval& batch, Level level) {
  const auto note = [this](std::size_t lane, const EditLog& log) {
    note_touched(log, touched_by_lane_[lane]);
  };
  if (!batch.run(level, note)) return;
  for (Touched& by_lane : touched_by_lane_) {
    touched_.edges.insert(touched_.edges.end(), by_lane.edges.begin(), by_lane.edges.end());
    touched_.nodes.insert(touched_.nodes.end(), by_lane.nodes.begin(), by_lane.nodes.end());
    by_lane = {};
  }
}

void HistoryRecorder::note_touched(const EditLog& log, Touched& touched) {
  for (const auto& kept : log.touched_nodes()) touch(kept.id, touched);
  for (const auto& kept : log.touched_edges()) touch(kept.id, touched);
}

/// The edge is now part of a larger outline.
void HistoryRecorder::enlarge_loop(EdgeId e, LoopSize size) {
  loop_sizes_[e] = std::max(loop_sizes_[e], size);
  edge_version_[e] = kNoVersion;
}

/// The nodes along edges whose face changed now belong to another feature.
void HistoryRecorder::touch_along(const TrapezoidalGraph& graph, const EditLog& log) {
  for (const EdgeId e : stack_.last_block_edges()) {
    if (loop_sizes_[e] >= *stack_.last_block_size()) continue;
    enlarge_loop(e, *stack_.last_block_size());
    touch(e, touched_);
  }
  for (const auto& kept : log.touched_edges()) {
    const Edge& edge = graph.edge(kept.id);
    if (!edge.is_alive() || (edge.face[kLeft] == kept.record.face[kLeft] &&
                             edge.face[kRight] == kept.record.face[kRight])) {
      continue;
    }
    if (const std::optional<LoopSize> size = stack_.last_block_size()) enlarge_loop(kept.id, *size);
    for (const Side s : {kLeft, kRight}) {
      for (NodeId n = edge.extreme[s][kUp]; !n.is_none();
           n = graph.node(n).link[opposite(s)][kDown])
        touch(n, touched_);
    }
  }
}

void HistoryRecorder::note_lost_area(const TrapezoidalGraph& graph, Level level) {
  const Removal removal = stack_.last_removal();
  if (removal != Removal::loop && removal != Removal::region) return;
  if (!graph.is_coverage()) return note_lost_loop(level);
  for (const Taken& taken : stack_.last_taken()) note_taken(taken, level);
}

/// Only features that cover just one of the two faces have lost, or gained, the area.
void HistoryRecorder::note_taken(const Taken& taken, Level level) {
  add_grains(taken.axis, taken.area, level, taken.face, taken.taker);
  add_grains(taken.axis, -taken.area, level, taken.taker, taken.face);
}

void HistoryRecorder::add_grains(const Axis& axis, double area, Level level, FaceId face,
                                 FaceId other) {
  bool is_covered = !rows_->of(other).empty();
  for_each_apart(rows_->of(face), rows_->of(other), [&](std::uint32_t row) {
    history_->grains.push_back({axis, area, level, row, is_covered});
    is_covered = true;  // by the first feature
  });
}

void HistoryRecorder::note_lost_loop(Level level) {
  const Loop& loop = loops_[loop_of_[stack_.last_corner()]];
  history_->grains.push_back(
      {loop.axis, loop.is_hole ? -loop.area : loop.area, level, rows_->of(1).front()});
}

void HistoryRecorder::end_level(const TrapezoidalGraph& graph, Level level) {
  put_in_order(touched_.edges, edge_is_touched_);
  for (const EdgeId e : touched_.edges) {
    edge_is_touched_[e] = 0;
    renew_edge(graph, e);
  }
  touched_.edges.clear();
  put_in_order(touched_.nodes, node_is_touched_);
  for (const NodeId n : touched_.nodes) {
    node_is_touched_[n] = 0;
    renew_node(graph, n, level);
  }
  touched_.nodes.clear();
}

/// Edges without features on either side lie between pieces of the void and are not visible.
bool HistoryRecorder::has_features_beside(const Edge& edge) const {
  return !rows_->of(edge.face[kLeft]).empty() || !rows_->of(edge.face[kRight]).empty();
}

/// An edge whose ends have changed starts a new version, and so do the inside nodes along it.
void HistoryRecorder::renew_edge(const TrapezoidalGraph& graph, EdgeId e) {
  if (graph.is_frame(e)) return;
  const Edge& edge = graph.edge(e);
  if (!edge.is_alive()) {
    edge_version_[e] = kNoVersion;
    return;
  }
  if (!has_features_beside(edge)) return;
  if (edge_version_[e] != kNoVersion) {
    const MeshEdge& open = history_->edges[edge_version_[e]];
    if (open.upper == vertex_base_ + edge.end[kUp].value - 1 &&
        open.lower == vertex_base_ + edge.end[kDown].value - 1) {
      return;
    }
  }
  open_edge(graph, e);
  for (const Side s : {kLeft, kRight}) {
    if (rows_->of(edge.face[s]).empty()) continue;
    for (NodeId n = edge.extreme[s][kUp]; !n.is_none(); n = graph.node(n).link[opposite(s)][kDown])
      touch(n, touched_);
  }
}

void HistoryRecorder::open_edge(const TrapezoidalGraph& graph, EdgeId e) {
  const Edge& edge = graph.edge(e);
  edge_version_[e] = static_cast<std::uint32_t>(history_->edges.size());
  history_->edges.push_back(
      {vertex_base_ + edge.end[kUp].value - 1, vertex_base_ + edge.end[kDown].value - 1});
  history_->loop_sizes.push_back(loop_sizes_[e]);
  require_countable(history_->edges.size(), "versions of edges");
}

void HistoryRecorder::renew_node(const TrapezoidalGraph& graph, NodeId n, Level level) {
  const Node& node = graph.node(n);
  std::uint32_t& version = node_version_[n];
  const bool is_inside = node.is_alive() && !rows_->of(graph.face(node)).empty();
  const MeshTrapezoid now = is_inside ? trapezoid_of(node) : MeshTrapezoid{};
  const auto rows = is_inside ? rows_of(graph, node, now) : std::span<const std::uint32_t>();
  if (version != kNoVersion) {
    if (!rows.empty() && is_open(version, now, rows)) return;
    const std::uint32_t first = version;
    do lifespan_of(*history_, version++).dies = level;
    while (is_copy(version, first));
  }
  version = rows.empty() ? kNoVersion : open_node(now, rows, level);
}

/// The features to which the node belongs. For a node without height: the features whose boundary
/// its horizontal edge is, since other features may lie on both sides of that.
std::span<const std::uint32_t> HistoryRecorder::rows_of(const TrapezoidalGraph& graph,
                                                        const Node& node,
                                                        const MeshTrapezoid& trapezoid) {
  const auto rows = rows_->of(graph.face(node));
  if (rows_->shared().empty() || has_height(*history_, trapezoid)) return rows;
  const std::optional<std::uint32_t> edge = horizontal_edge_of(*history_, trapezoid);
  if (!edge) return {};
  const Side side = *edge == trapezoid.left ? kLeft : kRight;
  apart_.clear();
  for_each_apart(rows, rows_->of(graph.edge(node.edge[side]).face[side]),
                 [this](std::uint32_t row) { apart_.push_back(row); });
  return apart_;
}

MeshTrapezoid HistoryRecorder::trapezoid_of(const Node& node) const {
  return {vertex_base_ + node.end[kUp].value - 1, vertex_base_ + node.end[kDown].value - 1,
          edge_version_[node.edge[kLeft]], edge_version_[node.edge[kRight]]};
}

bool HistoryRecorder::is_open(std::uint32_t version, const MeshTrapezoid& trapezoid,
                              std::span<const std::uint32_t> rows) const {
  const std::uint32_t i = version & ~kHorizontalBit;
  const auto row_at = [&](std::uint32_t k) {
    return i == version ? history_->rows[k] : history_->horizontal_edges[k].row;
  };
  const bool is_same = i == version ? covers_the_same(*history_, history_->trapezoids[i], trapezoid)
                                    : !has_height(*history_, trapezoid) &&
                                          horizontal_edge_of(*history_, trapezoid) ==
                                              history_->horizontal_edges[i].edge;
  if (!is_same) return false;
  if (rows_->shared().empty()) return row_at(i) == rows.front();
  for (std::uint32_t k = 0; k < rows.size(); ++k) {
    if ((k > 0 && !is_copy(version + k, version)) || row_at(i + k) != rows[k]) return false;
  }
  return !is_copy(version + static_cast<std::uint32_t>(rows.size()), version);
}

/// Whether both versions represent the same node at the same time, for several features.
bool HistoryRecorder::is_copy(std::uint32_t version, std::uint32_t of) const {
  if (rows_->shared().empty()) return false;
  const std::uint32_t i = version & ~kHorizontalBit;
  const std::uint32_t k = of & ~kHorizontalBit;
  if ((of & kHorizontalBit) == 0) {
    return i < history_->trapezoids.size() && history_->trapezoids[i] == history_->trapezoids[k] &&
           history_->lifespans[i].born == history_->lifespans[k].born;
  }
  return i < history_->horizontal_edges.size() && history_->horizontal_edges[i].is_copy;
}

// A trapezoid between two vertices of the same y has no area and is never drawn; the edge along it
// may be.
std::uint32_t HistoryRecorder::open_node(const MeshTrapezoid& trapezoid,
                                         std::span<const std::uint32_t> rows, Level level) {
  const Lifespan lifespan{level, kNeverDies};
  if (has_height(*history_, trapezoid)) {
    const auto first = static_cast<std::uint32_t>(history_->trapezoids.size());
    for (const std::uint32_t row : rows) {
      history_->trapezoids.push_back(trapezoid);
      history_->lifespans.push_back(lifespan);
      history_->rows.push_back(row);
    }
    require_countable(history_->trapezoids.size(), "versions of trapezoids", kMostVersions);
    return first;
  }
  const std::optional<std::uint32_t> edge = horizontal_edge_of(*history_, trapezoid);
  if (!edge) return kNoVersion;
  const auto first = static_cast<std::uint32_t>(history_->horizontal_edges.size());
  for (const std::uint32_t row : rows) {
    const bool is_copy = history_->horizontal_edges.size() > first;
    history_->horizontal_edges.push_back({*edge, lifespan, row, is_copy});
  }
  require_countable(history_->horizontal_edges.size(), "versions of horizontal edges",
                    kMostVersions);
  return first | kHorizontalBit;
}

}  // namespace trapeze
