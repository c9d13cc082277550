// Batch generalization (paper, section 6): the removals of one level are carried out at once, on
// several threads, and the result is, record by record, that of one after another.
//
// The graph is divided into slabs by the order of the sweep, one for each lane, and a lane carries
// out the removals within its slab in their sequence. Removals that have no record of the graph in
// common may change places in the sequence. So what cannot be done at once is put off: a removal
// that reaches into another slab, one that changes what a removal before it, put off, is going to
// read or change. What is put off holds what it may come to touch, so that nothing that follows it
// in the sequence and meets it can overtake it; it is carried out after the batch, by the stack, in
// its place in the sequence. Why this is right is in core/README.md.
//
// Regions reach as far as their borders: a batch ends where the next one of them is due. That a
// loop has gone is reported after the batch, as the regions on both sides of it become one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "core/graph/edit_log.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/grid/tolerance.h"

namespace trapeze {

/// What removals that were put off may come to touch.
class Held {
 public:
  void assign(const TrapezoidalGraph& graph);

  /// A corner whose next removal, or retrial, is to be put off; lanes may ask for any corner.
  bool has(CornerId c) const { return state(c) != kFree; }
  /// The corner with all it may touch.
  bool has_whole(CornerId c) const { return state(c) == kWhole; }
  bool has(EdgeId e) const { return edges_[e] != 0; }
  bool has(VertexId v) const { return vertices_[v] != 0; }

  void hold(CornerId c);
  void hold_whole(CornerId c);
  void hold(EdgeId e) { edges_[e] = 1; }
  void hold(VertexId v) { vertices_[v] = 1; }

  EditReach reach(VertexId first, VertexId last) const {
    return {first, last, &vertices_, &edges_};
  }

 private:
  static constexpr std::uint8_t kFree = 0;
  static constexpr std::uint8_t kAlone = 1;
  static constexpr std::uint8_t kWhole = 2;
  std::uint8_t state(CornerId c) const;

  mutable Table<CornerId, std::uint8_t> corners_;
  Table<EdgeId, std::uint8_t> edges_;
  Table<VertexId, std::uint8_t> vertices_;
};

/// The removals of a batch in one slab. One thread at a time, and no two for one slab.
class BatchLane : public PriorityStack::Batch {
 public:
  using Removed = std::function<void(const EditLog&)>;

  BatchLane(PriorityStack& stack, TrapezoidalGraph& graph, Held& held);
  BatchLane(const BatchLane&) = delete;
  BatchLane& operator=(const BatchLane&) = delete;

  /// The slab: the vertices from `first` to `last`.
  void begin(VertexId first, VertexId last);
  /// Takes what of these is due in the slab.
  void gather(std::span<const PriorityStack::Candidate> due);
  void take(const PriorityStack::Candidate& retry);
  /// Corners of the batch in the slab whose edges lead out of it.
  std::span<const CornerId> leading_out() const { return leading_out_; }
  bool has(VertexId v) const { return reach_.first <= v && v <= reach_.last; }
  /// Whether the corner and its neighbours lie in the slab.
  bool has(CornerId c) const;
  /// Holds the corner and what its removal may touch, and so on for all that may go with it.
  void hold(CornerId c);

  /// Carries out what was gathered, and what is to be tried again before `end`, if there is one.
  void run(const PriorityStack::Candidate* end, const Removed& removed);

  // Called by the stack.
  bool may_try(CornerId c) override;
  bool carry_out(CornerId c, const Decision& decision, EditLog& log) override;
  void wait_for(CornerId corner, VertexId blocker) override;
  void retry_waiting(VertexId gone) override;

  /// Trapezoids walked and touched.
  std::uint64_t work() const { return lane_.counts.walked + lane_.counts.touched; }
  /// Gives the stack what is left: corners that wait, or are to be tried again, and counts.
  void end(std::vector<PriorityStack::PutOff>& put_off);

 private:
  using Candidate = PriorityStack::Candidate;
  using PutOff = PriorityStack::PutOff;
  using Waiting = PriorityStack::Waiting;

  std::optional<Candidate> next(const Candidate* end);
  void fetch_candidates() const;
  bool is_free(CornerId c) const;
  bool is_free(EdgeId e, std::size_t& nodes) const;
  bool is_free_loop(CornerId c) const;
  void put_off(CornerId c, PriorityStack::PutOff::What what);
  void hold_vertex(VertexId v);
  const Waiting& waiting_at(std::uint32_t i) const;

  PriorityStack& stack_;
  TrapezoidalGraph& graph_;
  Held& held_;
  EditReach reach_;
  PriorityStack::Lane lane_;
  std::vector<Candidate> due_;
  std::size_t position_ = 0;
  std::vector<CornerId> leading_out_;
  std::vector<CornerId> to_hold_;
  Candidate key_;  // that fell due last
  Candidate at_;   // what is tried
  std::vector<PutOff> put_off_;
  // Corners that wait, and for which vertex; their numbers have a bit that those of the stack do
  // not have.
  std::vector<Waiting> waiting_;
  std::vector<VertexId> blockers_;
};

class BatchRemoval {
 public:
  /// Called after each removal, on the thread of the lane.
  using Removed = std::function<void(std::size_t lane, const EditLog&)>;

  /// `stack` is that of `graph`; both must outlive this.
  BatchRemoval(PriorityStack& stack, TrapezoidalGraph& graph, unsigned threads);
  ~BatchRemoval();

  std::size_t lanes() const { return lanes_.size(); }

  /// If many removals of the level come next in the sequence of the stack: carries out those that
  /// may be carried out now. The others are the stack's next ones. False if they are too few.
  bool run(Level level, const Removed& removed);

 private:
  std::size_t end_of_batch(Level level) const;
  BatchLane& lane_of(VertexId v) const;
  bool leads_out(CornerId c) const;
  void gather(std::size_t end);
  void gather_retries(const PriorityStack::Candidate* end);
  void note_work() const;
  void collect_blocked(std::size_t share, std::vector<CornerId>& leading_out) const;

  PriorityStack& stack_;
  TrapezoidalGraph& graph_;
  unsigned threads_;
  Held held_;
  std::vector<std::unique_ptr<BatchLane>> lanes_;
  std::size_t looked_at_ = 0;  // candidates of which too few are due in a row
};

}  // namespace trapeze
