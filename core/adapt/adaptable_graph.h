// One polygon's trapezoidal graph, adapted in place to any tolerance, forwards and back (paper,
// section 3.2).
//
// All vertices are in a priority stack, ordered by weight and then by vertex. Adapting to a
// tolerance pops every vertex of smaller weight and removes it, unless the topological consistency
// test blocks it. A blocked vertex is tried again as soon as its blocker or one of its neighbours
// in the ring has been removed, with the weight of the vertex popped last. So there is one fixed
// sequence of removals, and the graph at a tolerance is the result of a prefix of it. It depends on
// the tolerance only, never on the tolerances it was adapted to before.
//
// The two anchors of a ring, between which all its other vertices are weighed, have no finite
// weight and are removed with its last triangle. Where rings hook into each other so that all
// vertices of finite weight are blocked, the anchors are given weights as well: an innermost ring
// always has two vertices whose triangles are empty, so in the end everything is removed.
//
// In a coverage, each arc is weighed by itself, so that a border is the same for the polygons on
// both sides, and regions are in the stack too (see region_borders.h). Where a junction has become
// a corner of one arc, the weights of the arcs that met there no longer bound how far that arc
// deviates from its original position. So that corner, and the corners next to corners removed this
// way, are weighed in place: by all vertices removed between their neighbours.
//
// Thread-safety: none; different graphs may be used by different threads.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/adapt/generalization_options.h"
#include "core/adapt/vertex_weight.h"
#include "core/borders/region_borders.h"
#include "core/graph/edit_log.h"
#include "core/graph/generalization.h"
#include "core/graph/topological_consistency.h"
#include "core/graph/trapezoidal_graph.h"

namespace trapeze {

class BatchLane;
class BatchRemoval;

/// The corners of a graph in order of removal, and the corners that are blocked.
class PriorityStack {
 public:
  /// Weighs all corners of the graph and sorts them, on up to `threads` threads. `graph` must
  /// outlive the use of the stack, and so must `plan`, which says how regions of a coverage become
  /// blocks, if it is not null.
  void assign(const TrapezoidalGraph& graph, const GeneralizationOptions& options,
              unsigned threads = 1, const MergePlan* plan = nullptr);

  /// Carries out the next removal of the sequence through `log` and returns its tolerance in cells:
  /// the graph at a tolerance has had all removals of smaller ones. None if no vertex of finite
  /// weight can be removed any more.
  std::optional<double> remove_next(const TrapezoidalGraph& graph, EditLog& log);

  struct Counts {
    std::uint64_t removals = 0;
    std::uint64_t tests = 0;    // decisions made
    std::uint64_t walked = 0;   // trapezoids examined for them
    std::uint64_t touched = 0;  // trapezoids changed by removals
    std::uint64_t at_once = 0;  // removals carried out in batches
    /// The part of `walked` and `touched` that runs in parallel with other work, if every thread of
    /// a batch has a core.
    std::uint64_t beside = 0;
  };
  const Counts& counts() const { return main_.counts; }

  /// Whether any vertex has been blocked so far.
  bool has_blocked() const { return main_.has_blocked; }

  /// The corner removed last, and how it was removed.
  CornerId last_corner() const { return last_corner_; }
  Removal last_removal() const { return last_removal_; }
  /// In a coverage: the areas that went to another face in the last removal of a loop or a region.
  std::span<const Taken> last_taken() const { return borders_.taken(); }
  /// Size of the loop around the block that the region removed last became a part of, if any, and
  /// the edges of the block if those besides the ones whose face has changed do not know it.
  std::optional<LoopSize> last_block_size() const { return borders_.block_size(); }
  std::span<const EdgeId> last_block_edges() const { return borders_.block_edges(); }
  double weight(CornerId c) const { return weights_[c]; }

 private:
  /// A corner with its sort keys, so that sorting reads nothing else. Corner numbers beyond the
  /// existing ones represent regions, which come after the vertices of the same weight.
  struct Candidate {
    double weight;
    VertexId vertex;
    CornerId corner;
    friend auto operator<=>(const Candidate&, const Candidate&) = default;
  };

  enum class State : std::uint8_t { ahead, blocked, queued };
  // A list of the corners blocked by one vertex: a corner and the index of the next one.
  struct Waiting {
    CornerId corner;
    std::uint32_t next;
  };
  static constexpr std::uint32_t kNobody = 0xffffffff;  // instead of an index: the end of a list
  /// What is done differently while a batch is carried out; see batch_removal.h.
  class Batch {
   public:
    virtual ~Batch() = default;
    /// False if the corner has been put off.
    virtual bool may_try(CornerId c) = 0;
    /// Removes the corner if it is not blocked. False if it has been put off.
    virtual bool carry_out(CornerId c, const Decision& decision, EditLog& log) = 0;
    virtual void wait_for(CornerId corner, VertexId blocker) = 0;
    virtual void retry_waiting(VertexId gone) = 0;
  };
  /// Removals in sequence: usually all of them; while a batch is carried out, those of one part of
  /// the graph.
  struct Lane {
    double epsilon = 0;              // greatest weight popped
    std::vector<Candidate> retries;  // corners to be tried again, smallest first (a heap)
    bool has_blocked = false;
    Counts counts;
    Batch* batch = nullptr;
  };
  /// Precedes every other candidate.
  static constexpr Candidate kFirst = {-1, VertexId(0), CornerId(0)};
  /// Work that a batch leaves to be done in its place in the sequence: when `key` is due, and after
  /// everything that is tried before `at` then.
  struct PutOff {
    enum class What : std::uint8_t { to_try, to_retry, to_report };

    Candidate key;
    Candidate at;
    CornerId corner;
    What what = What::to_try;
    LostLoop loop = {};  // to be reported
  };
  friend class BatchLane;
  friend class BatchRemoval;

  void weigh_corners();
  void weigh_regions(const MergePlan* plan, std::vector<Candidate>& candidates);
  void weigh_loop(CornerId first);
  void weigh_arc(CornerId first);
  void add_candidates(std::span<const double> weights);
  std::optional<Candidate> next_candidate();
  bool is_before_put_off(const Candidate& retry) const;
  std::optional<Candidate> next_put_off();
  LostLoop lost_loop_at(CornerId c) const;
  void report(const PutOff& lost, EditLog& log);
  Candidate pop();
  void fetch_candidates() const;
  static void enqueue(Lane& lane, const Candidate& candidate);
  static Candidate pop_retry(Lane& lane);
  const Candidate* next_retry() const;
  Candidate pop_next_retry();
  bool is_region(CornerId c) const { return c.value >= weights_.size(); }
  CornerId corner_for(RegionId region) const { return CornerId(weights_.size() + region.value); }
  RegionId region_of(CornerId c) const { return RegionId(c.value - weights_.size()); }
  bool remove_region(RegionId region, EditLog& log);
  void note_joined(const Corner& gone, CornerId corner, EdgeId edge_before);
  bool is_to_wait(Lane& lane, CornerId corner);
  bool remove_corner(Lane& lane, CornerId corner, EditLog& log);
  void requeue_united(const RegionBorders::United& united);
  void requeue_region(RegionId region, double weight);
  double weight_in_place(CornerId c) const;
  bool enqueue_anchors();
  void wait_for(Lane& lane, CornerId corner, VertexId blocker);
  void retry_waiting(Lane& lane, VertexId gone);
  void retry_if_blocked(Lane& lane, CornerId corner);

  const TrapezoidalGraph* graph_ = nullptr;
  GeneralizationOptions options_;
  Table<CornerId, double> weights_;
  LargeArray<Candidate> order_;
  std::size_t position_ = 0;
  Lane main_;
  std::vector<Candidate> region_retries_;  // as in lanes, so that the next one is at hand
  std::vector<PutOff> put_off_;            // by the last batch, in sequence order
  std::size_t next_put_off_ = 0;
  std::optional<PutOff> to_report_;

  Table<CornerId, State> state_;
  Table<VertexId, std::uint32_t> waiting_first_;  // by blocker
  std::vector<Waiting> waiting_;
  VertexWeights ring_weights_;
  std::vector<Point> ring_;
  std::vector<CornerId> ring_corners_;
  // In a coverage.
  RegionBorders borders_;
  Table<RegionId, double> region_weights_;     // as last queued
  Table<CornerId, std::uint8_t> is_in_place_;  // whether weighed in place
  // Corners removed from an edge, as a circular list: one of them by edge, and the next of each.
  Table<EdgeId, CornerId> gone_from_;
  Table<CornerId, CornerId> next_gone_;
  CornerId last_corner_;
  Removal last_removal_ = Removal::blocked;
};

class AdaptableGraph {
 public:
  /// `plan`, if not null, must outlive the graph.
  explicit AdaptableGraph(TrapezoidalGraph graph, const GeneralizationOptions& options = {},
                          const MergePlan* plan = nullptr);
  AdaptableGraph(const AdaptableGraph&) = delete;
  AdaptableGraph& operator=(const AdaptableGraph&) = delete;

  /// Adapts the graph to the tolerance `epsilon` (cells, >= 0), forwards or back.
  void adapt_to(double epsilon);

  /// The tolerances at which the graph equals the present one: greater than `above`, up to and
  /// including `up_to`.
  struct Unchanged {
    double above = -1;  // below zero: nothing has been removed
    double up_to = 0;

    bool contains(double epsilon) const { return above < epsilon && epsilon <= up_to; }
  };
  Unchanged unchanged() const;

  const TrapezoidalGraph& graph() const { return graph_; }
  const PriorityStack& stack() const { return stack_; }
  std::size_t memory() const { return graph_.memory() + log_.memory(); }

 private:
  TrapezoidalGraph graph_;
  EditLog log_;
  PriorityStack stack_;
  std::vector<double> epsilon_of_edit_;
  bool exhausted_ = false;
};

}  // namespace trapeze
