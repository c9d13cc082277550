// Batch generalization (paper, section 6): the removals of one level are carried out on several
// threads, and the result equals, record by record, that of removing one vertex after another.
//
// The graph is divided into slabs in sweep order, one for each lane, and a lane carries out the
// removals within its slab in their sequence. Removals that share no record of the graph commute.
// Others are put off: removals that reach into another slab, and removals that change something
// that an earlier removal, itself put off, is going to read or change. A removal that is put off
// holds everything that it may touch, so that no later removal that meets it can overtake it. The
// stack carries it out after the batch, in its place in the sequence. core/README.md has the proof.
//
// Regions reach as far as their borders, so a batch ends where the next region is due. Loops that
// were removed are reported after the batch, as the regions on both sides of them become one.
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

/// The records that removals put off may touch.
class Held {
 public:
  void assign(const TrapezoidalGraph& graph);

  /// Whether the next removal, or retrial, of the corner is to be put off; lanes may query any
  /// corner.
  bool has(CornerId c) const { return state(c) != kFree; }
  /// Whether the corner is held together with everything its removal may touch.
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

/// The removals of a batch in one slab. Call it from one thread at a time; no two lanes share a
/// slab.
class BatchLane : public PriorityStack::Batch {
 public:
  using Removed = std::function<void(const EditLog&)>;

  BatchLane(PriorityStack& stack, TrapezoidalGraph& graph, Held& held);
  BatchLane(const BatchLane&) = delete;
  BatchLane& operator=(const BatchLane&) = delete;

  /// Sets the slab: the vertices from `first` to `last`.
  void begin(VertexId first, VertexId last);
  /// Takes the candidates that are due in the slab.
  void gather(std::span<const PriorityStack::Candidate> due);
  void take(const PriorityStack::Candidate& retry);
  /// Corners of the batch in the slab whose edges lead out of it.
  std::span<const CornerId> leading_out() const { return leading_out_; }
  bool has(VertexId v) const { return reach_.first <= v && v <= reach_.last; }
  /// Whether the corner and its neighbours lie in the slab.
  bool has(CornerId c) const;
  /// Holds the corner and everything its removal may touch, and does the same for all corners that
  /// may be removed with it.
  void hold(CornerId c);

  /// Carries out the gathered removals, and retrials due before `end`, if there is one.
  void run(const PriorityStack::Candidate* end, const Removed& removed);

  // Called by the stack.
  bool may_try(CornerId c) override;
  bool carry_out(CornerId c, const Decision& decision, EditLog& log) override;
  void wait_for(CornerId corner, VertexId blocker) override;
  void retry_waiting(VertexId gone) override;

  /// Trapezoids walked and touched.
  std::uint64_t work() const { return lane_.counts.walked + lane_.counts.touched; }
  /// Returns the remaining work to the stack: corners that wait or are to be tried again, and the
  /// counts.
  void end(std::vector<PriorityStack::PutOff>& put_off);

 private:
  using Candidate = PriorityStack::Candidate;
  using PutOff = PriorityStack::PutOff;
  using Waiting = PriorityStack::Waiting;
  static constexpr std::uint32_t kNobody = PriorityStack::kNobody;

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
  Candidate key_;  // fell due last
  Candidate at_;   // being tried
  std::vector<PutOff> put_off_;
  // Corners that wait, and the vertex that each waits for. Their numbers have a bit that those of
  // the stack do not have.
  std::vector<Waiting> waiting_;
  std::vector<VertexId> blockers_;
};

class BatchRemoval {
 public:
  /// Called after each removal, on the thread of the lane.
  using Removed = std::function<void(std::size_t lane, const EditLog&)>;

  /// `stack` is the stack of `graph`; both must outlive this object.
  BatchRemoval(PriorityStack& stack, TrapezoidalGraph& graph, unsigned threads);
  ~BatchRemoval();

  std::size_t lanes() const { return lanes_.size(); }

  /// If many removals of the level come next in the sequence of the stack, carries out those that
  /// can be carried out now; the others are next on the stack. Returns false if there are too few.
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
  std::size_t looked_at_ = 0;  // up to here, too few candidates in a row are due
};

}  // namespace trapeze
