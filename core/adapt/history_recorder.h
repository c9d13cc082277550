// Records the history of a graph: carries out the sequence of removals once, from fine to coarse.
//
// Thread-safety: one call at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "core/adapt/history.h"
#include "core/adapt/milestones.h"
#include "core/borders/face_features.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/grid/work_share.h"

namespace trapeze {

class BatchRemoval;

/// Reusable memory for recording; one call at a time.
class HistoryRecorder {
 public:
  /// Appends the history of `graph` to `history`. Face f belongs to the features whose rows are
  /// rows.of(f); faces become blocks by `plan`, if it is not null. Afterwards `graph` is adapted to
  /// the coarsest tolerance. If given, `share` receives the fraction of the vertices removed, from
  /// time to time. Runs on up to `threads` threads; the history does not depend on their number.
  /// Throws std::length_error if there are more versions than 32 bits can count.
  ///
  /// The time of a removal grows with the number of trapezoids along the edges that are joined.
  /// Where that is a few for most removals and thousands for all (a star of a hundred thousand
  /// rays), removing stops after most_work(): levels from then on keep the remaining vertices.
  /// Several threads notice this somewhat later. Returns the tolerance at which that happened
  /// (cells); usually none.
  std::optional<double> record(TrapezoidalGraph& graph, const FaceFeatures& rows,
                               const GeneralizationOptions& options, History& history,
                               WorkShare* share = nullptr, unsigned threads = 1,
                               const MergePlan* plan = nullptr);
  /// The same for a single polygon, which is the feature of row 0.
  std::optional<double> record(TrapezoidalGraph& graph, const GeneralizationOptions& options,
                               History& history);

  /// How many trapezoids may be examined and changed to simplify so many vertices: 50 times as many
  /// as real outlines and coverages of any size need, and at least 2^27 (half a second).
  static std::uint64_t most_work(std::size_t vertices);

  /// The stack of the last recording.
  const PriorityStack& stack() const { return stack_; }

 private:
  void begin(const TrapezoidalGraph& graph, History& history);
  void measure_loops(const TrapezoidalGraph& graph);
  /// Records changed since the last level, in any order.
  struct Touched {
    std::vector<EdgeId> edges;
    std::vector<NodeId> nodes;
  };
  void remove_batch(BatchRemoval& batch, Level level);
  void note_touched(const EditLog& log, Touched& touched);
  void touch_along(const TrapezoidalGraph& graph, const EditLog& log);
  void note_lost_area(const TrapezoidalGraph& graph, Level level);
  void note_lost_loop(Level level);
  void note_taken(const Taken& taken, Level level);
  void add_grains(const Axis& axis, double area, Level level, FaceId face, FaceId other);
  void end_level(const TrapezoidalGraph& graph, Level level);
  bool has_features_beside(const Edge& edge) const;
  void renew_edge(const TrapezoidalGraph& graph, EdgeId e);
  void renew_node(const TrapezoidalGraph& graph, NodeId n, Level level);
  MeshTrapezoid trapezoid_of(const Node& node) const;
  std::span<const std::uint32_t> rows_of(const TrapezoidalGraph& graph, const Node& node,
                                         const MeshTrapezoid& trapezoid);
  bool is_open(std::uint32_t version, const MeshTrapezoid& trapezoid,
               std::span<const std::uint32_t> rows) const;
  std::uint32_t open_node(const MeshTrapezoid& trapezoid, std::span<const std::uint32_t> rows,
                          Level level);
  bool is_copy(std::uint32_t version, std::uint32_t of) const;
  void open_edge(const TrapezoidalGraph& graph, EdgeId e);
  void enlarge_loop(EdgeId e, LoopSize size);
  void touch(NodeId n, Touched& touched);
  void touch(EdgeId e, Touched& touched);

  History* history_ = nullptr;
  const FaceFeatures* rows_ = nullptr;
  std::uint32_t vertex_base_ = 0;
  PriorityStack stack_;
  // The currently open version by edge and by node; kNoVersion if there is none. The version of a
  // node without height is its horizontal edge, if it has one, flagged with kHorizontalBit. If
  // several features have one, it is that of the first.
  Table<EdgeId, std::uint32_t> edge_version_;
  Table<NodeId, std::uint32_t> node_version_;
  Table<EdgeId, LoopSize> loop_sizes_;  // as at the start
  Milestones milestones_;
  std::vector<std::uint32_t> apart_;  // for rows_of()
  Touched touched_;
  std::vector<Touched> touched_by_lane_;  // in a batch
  Table<EdgeId, std::uint8_t> edge_is_touched_;
  Table<NodeId, std::uint8_t> node_is_touched_;
  // Loops as at the start.
  struct Loop {
    Axis axis;
    double area = 0;  // cells squared
    bool is_hole = false;
  };
  std::vector<Loop> loops_;
  Table<CornerId, std::uint32_t> loop_of_;
};

}  // namespace trapeze
