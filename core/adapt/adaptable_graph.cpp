#include "core/adapt/adaptable_graph.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "core/graph/fetch_ahead.h"
#include "core/grid/for_each_in_parallel.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kNobody = 0xffffffff;

// How far ahead, in candidates, each step is prefetched: its memory arrives after some hundred
// nanoseconds, and is then still in the first-level cache.
constexpr std::size_t kCornerAhead = 24;
constexpr std::size_t kEdgesAhead = 16;
constexpr std::size_t kNodesAhead = 8;
constexpr std::size_t kNeighboursAhead = 4;

}  // namespace

void PriorityStack::assign(const TrapezoidalGraph& graph, const GeneralizationOptions& options,
                           unsigned threads, const MergePlan* plan) {
  graph_ = &graph;
  options_ = options;
  const std::size_t count = graph.corners().size();
  weights_.assign(count, std::numeric_limits<double>::quiet_NaN());
  order_.clear();
  if (graph.is_coverage()) {
    std::vector<Candidate> regions;
    for_each_in_parallel(2, threads, [&](std::size_t i) {
      if (i == 0) weigh_corners();
      if (i == 1) weigh_regions(plan, regions);
    });
    const auto corners = static_cast<std::ptrdiff_t>(order_.size());
    order_.insert(order_.end(), regions.begin(), regions.end());
    std::inplace_merge(order_.begin(), order_.begin() + corners, order_.end());
  } else {
    weigh_corners();
  }
  position_ = 0;
  epsilon_ = 0;
  retries_.clear();
  state_.assign(count, State::ahead);
  waiting_first_.assign(graph.vertices().size(), kNobody);
  waiting_.clear();
  has_blocked_ = false;
  counts_ = {};
}

void PriorityStack::weigh_corners() {
  const std::size_t count = graph_->corners().size();
  for (std::size_t i = 0; i < count && graph_->is_coverage(); ++i) {
    const Corner& corner = graph_->corner(CornerId(i));
    if (corner.is_end() && corner.prev.is_none()) weigh_arc(CornerId(i));
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isnan(weights_[CornerId(i)])) weigh_loop(CornerId(i));
  }
  std::sort(order_.begin(), order_.end());
}

void PriorityStack::weigh_loop(CornerId first) {
  ring_.clear();
  ring_corners_.clear();
  CornerId c = first;
  do {
    ring_.push_back(graph_->point(graph_->corner(c).vertex));
    ring_corners_.push_back(c);
    c = graph_->corner(c).next;
  } while (c != first);
  add_candidates(ring_weights_.weigh(ring_, options_.weights));
}

void PriorityStack::weigh_arc(CornerId first) {
  ring_.clear();
  ring_corners_.clear();
  for (CornerId c = first; !c.is_none(); c = graph_->corner(c).next) {
    ring_.push_back(graph_->point(graph_->corner(c).vertex));
    ring_corners_.push_back(c);
  }
  add_candidates(ring_weights_.weigh_arc(ring_, options_.weights));
}

void PriorityStack::add_candidates(std::span<const double> weights) {
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const CornerId corner = ring_corners_[k];
    weights_[corner] = weights[k];
    if (!std::isfinite(weights[k])) continue;
    order_.push_back({weights[k], graph_->corner(corner).vertex, corner});
  }
}

void PriorityStack::weigh_regions(const MergePlan* plan, std::vector<Candidate>& candidates) {
  borders_.assign(*graph_, plan);
  region_weights_.clear();
  for (std::size_t i = 0; i < borders_.count(); ++i) {
    const double weight = borders_.weight(RegionId(i));
    region_weights_.push_back(weight);
    if (std::isfinite(weight)) candidates.push_back({weight, {}, corner_for(RegionId(i))});
  }
  std::sort(candidates.begin(), candidates.end());
  is_in_place_.assign(weights_.size(), false);
  gone_from_.assign(graph_->edges().size(), CornerId());
  next_gone_.assign(weights_.size(), CornerId());
}

std::optional<PriorityStack::Candidate> PriorityStack::next_candidate() {
  // A candidate that is due already precedes those still to come.
  const bool has_more = position_ < order_.size();
  if (!retries_.empty() &&
      (retries_.front().weight <= epsilon_ || !has_more || retries_.front() < order_[position_])) {
    std::pop_heap(retries_.begin(), retries_.end(), std::greater<>());
    const Candidate next = retries_.back();
    retries_.pop_back();
    epsilon_ = std::max(epsilon_, next.weight);
    return next;
  }
  if (!has_more) return std::nullopt;
  return pop();
}

PriorityStack::Candidate PriorityStack::pop() {
  const Candidate next = order_[position_++];
  epsilon_ = std::max(epsilon_, next.weight);
  if (position_ + kCornerAhead < order_.size()) fetch_candidates();
  return next;
}

void PriorityStack::fetch_candidates() const {
  const auto ahead = [this](std::size_t distance) { return order_[position_ + distance]; };
  using FetchStep = RegionBorders::FetchStep;
  const auto fetch_region = [&](std::size_t distance, FetchStep step) {
    const CornerId corner = ahead(distance).corner;
    if (is_region(corner)) borders_.fetch(step, region_of(corner));
  };
  fetch_region(kCornerAhead, FetchStep::region);
  fetch_region(kEdgesAhead, FetchStep::seeds);
  fetch_region(kNodesAhead, FetchStep::edges);
  fetch_region(kNeighboursAhead, FetchStep::corners);
  const auto fetch_for = [&](std::size_t distance, const auto& fetch_step) {
    if (!is_region(ahead(distance).corner)) fetch_step(*graph_, ahead(distance).corner);
  };
  fetch_for(kCornerAhead, [&](const TrapezoidalGraph& graph, CornerId corner) {
    fetch(graph.corners(), corner);
    fetch(waiting_first_, ahead(kCornerAhead).vertex);
    fetch(state_, corner);
  });
  fetch_for(kEdgesAhead, fetch_edges);
  fetch_for(kNodesAhead, fetch_nodes);
  fetch_for(kNeighboursAhead, fetch_neighbours);
}

void PriorityStack::enqueue(const Candidate& candidate) {
  retries_.push_back(candidate);
  std::push_heap(retries_.begin(), retries_.end(), std::greater<>());
}

std::optional<double> PriorityStack::remove_next([[maybe_unused]] const TrapezoidalGraph& graph,
                                                 EditLog& log) {
  assert(&graph == graph_);
  do {
    while (const auto candidate = next_candidate()) {
      const bool has_gone = is_region(candidate->corner)
                                ? remove_region(region_of(candidate->corner), log)
                                : remove_corner(candidate->corner, log);
      if (!has_gone) continue;
      ++counts_.removals;
      counts_.touched += log.touched_nodes().size();
      return epsilon_;
    }
  } while (has_blocked_ && enqueue_anchors());
  return std::nullopt;
}

bool PriorityStack::remove_corner(CornerId c, EditLog& log) {
  const TrapezoidalGraph& graph = *graph_;
  if (!graph.corner(c).is_alive()) return false;  // went with its loop
  if (is_to_wait(c)) return false;
  const Decision decision = decide_removal(graph, c, options_.topology);
  ++counts_.tests;
  counts_.walked += decision.walked;
  if (decision.removal == Removal::blocked) {
    has_blocked_ = true;
    wait_for(c, decision.blocker);
    return false;
  }
  const Corner gone = graph.corner(c);
  const VertexId prev = graph.corner(gone.prev).vertex;
  const VertexId next = graph.corner(gone.next).vertex;
  const EdgeId edge_before = graph.corner(gone.prev).edge;
  if (decision.removal == Removal::loop && graph.is_coverage()) {
    const TriangleLoop loop = triangle_loop_at(graph, c);
    borders_.note_lost_loop(loop.long_edge, loop.side);
  }
  Generalization(graph, log).remove(c, decision.removal);
  last_corner_ = c;
  last_removal_ = decision.removal;
  retry_waiting(gone.vertex);
  if (decision.removal == Removal::loop) {
    retry_waiting(prev);
    retry_waiting(next);
    return true;
  }
  if (graph.is_coverage()) note_joined(gone, c, edge_before);
  retry_if_blocked(gone.prev);
  retry_if_blocked(gone.next);
  return true;
}

/// Of a coverage, after a corner went; `edge_before` led to it.
void PriorityStack::note_joined(const Corner& gone, CornerId corner, EdgeId edge_before) {
  const EdgeId joined = graph_->corner(gone.prev).edge;
  const EdgeId other = joined == edge_before ? gone.edge : edge_before;
  borders_.note_joined(other, joined, gone.prev);
  // Two circles become one when the successors of one of each are exchanged.
  next_gone_[corner] = corner;
  for (const EdgeId edge : {joined, other}) {
    if (!gone_from_[edge].is_none()) {
      std::swap(next_gone_[corner], next_gone_[gone_from_[edge]]);
    }
  }
  gone_from_[joined] = corner;
  if (!is_in_place_[corner.value]) return;
  is_in_place_[gone.prev.value] = true;
  is_in_place_[gone.next.value] = true;
}

/// A corner that is weighed where it stands is weighed whenever it is popped.
bool PriorityStack::is_to_wait(CornerId c) {
  if (!graph_->is_coverage() || !is_in_place_[c.value]) return false;
  weights_[c] = weight_in_place(c);
  if (weights_[c] <= epsilon_) return false;
  state_[c] = State::queued;
  enqueue({weights_[c], graph_->corner(c).vertex, c});
  return true;
}

double PriorityStack::weight_in_place(CornerId c) const {
  const auto at = [this](CornerId corner) { return graph_->point(graph_->corner(corner).vertex); };
  const Corner& corner = graph_->corner(c);
  const SegmentDistance distance(at(corner.prev), at(corner.next));
  double squared = distance.squared(at(c));
  if (!graph_->is_coverage()) return std::sqrt(squared);
  for (const EdgeId edge : {graph_->corner(corner.prev).edge, corner.edge}) {
    const CornerId first = gone_from_[edge];
    if (first.is_none()) continue;
    CornerId gone = first;
    do {
      squared = std::max(squared, distance.squared(at(gone)));
      gone = next_gone_[gone];
    } while (gone != first);
  }
  return std::sqrt(squared);
}

/// Gives a weight to the remaining anchors of rings; false if there are none.
bool PriorityStack::enqueue_anchors() {
  bool has_any = false;
  for (std::size_t i = 0; i < graph_->corners().size(); ++i) {
    const CornerId c(i);
    const Corner& corner = graph_->corner(c);
    if (!corner.is_alive() || corner.is_end() || std::isfinite(weights_[c])) continue;
    weights_[c] = weight_in_place(c);
    state_[c] = State::queued;
    enqueue({weights_[c], corner.vertex, c});
    has_any = true;
  }
  return has_any;
}

bool PriorityStack::remove_region(RegionId region, EditLog& log) {
  const double weight = borders_.weight(region);
  if (!std::isfinite(weight)) return false;
  if (weight > epsilon_) {
    requeue_region(region, weight);
    return false;
  }
  const RegionBorders::United united = borders_.remove(region, log);
  if (united.empty()) return false;
  last_removal_ = Removal::region;
  for (const VertexId v : borders_.changed()) retry_waiting(v);
  for (const CornerId c : borders_.dissolved()) {
    if (!graph_->corner(c).is_alive()) continue;  // went with a region that was united later
    is_in_place_[c.value] = true;
    is_to_wait(c);
    if (state_[c] != State::queued) {
      state_[c] = State::queued;
      enqueue({weights_[c], graph_->corner(c).vertex, c});
    }
  }
  requeue_united(united);
  return true;
}

/// What has grown is not measured again before it is popped; of a block, what is known of any part
/// of it will do.
void PriorityStack::requeue_united(const RegionBorders::United& united) {
  double known = 0;
  std::size_t unknown = 0;
  const auto parts = std::span(united).subspan(1);
  for (const RegionId part : parts) {
    const double weight = region_weights_[part];
    if (std::isfinite(weight)) {
      known = std::max(known, weight);
    } else {
      ++unknown;
    }
  }
  const bool is_known = borders_.has_plan() ? unknown < parts.size() : unknown == 0;
  if (!is_known) known = borders_.weight(united.front());
  if (std::isfinite(known)) requeue_region(united.front(), known);
}

void PriorityStack::requeue_region(RegionId region, double weight) {
  region_weights_[region] = weight;
  enqueue({weight, {}, corner_for(region)});
}

void PriorityStack::wait_for(CornerId corner, VertexId blocker) {
  state_[corner] = State::blocked;
  waiting_.push_back({corner, waiting_first_[blocker]});
  waiting_first_[blocker] = static_cast<std::uint32_t>(waiting_.size() - 1);
}

void PriorityStack::retry_waiting(VertexId gone) {
  std::uint32_t i = std::exchange(waiting_first_[gone], kNobody);
  for (; i != kNobody; i = waiting_[i].next) retry_if_blocked(waiting_[i].corner);
}

void PriorityStack::retry_if_blocked(CornerId corner) {
  if (state_[corner] != State::blocked || !graph_->corner(corner).is_alive()) return;
  state_[corner] = State::queued;
  enqueue({weights_[corner], graph_->corner(corner).vertex, corner});
}

AdaptableGraph::AdaptableGraph(TrapezoidalGraph graph, const GeneralizationOptions& options,
                               const MergePlan* plan)
    : graph_(std::move(graph)), log_(graph_) {
  stack_.assign(graph_, options, 1, plan);
}

void AdaptableGraph::adapt_to(double epsilon) {
  while (log_.applied() > 0 && epsilon_of_edit_[log_.applied() - 1] >= epsilon) log_.revert();
  while (log_.applied() < log_.size() && epsilon_of_edit_[log_.applied()] < epsilon) log_.apply();
  // The sequence continues from where it was followed to before; the tolerance of the next removal
  // is known only once it has been made, so one too many is made and reverted.
  while (log_.applied() == log_.size() && !exhausted_) {
    const std::optional<double> made = stack_.remove_next(graph_, log_);
    if (!made) {
      exhausted_ = true;
      return;
    }
    epsilon_of_edit_.push_back(*made);
    if (*made >= epsilon) {
      log_.revert();
      return;
    }
  }
}

AdaptableGraph::Unchanged AdaptableGraph::unchanged() const {
  const std::size_t applied = log_.applied();
  Unchanged unchanged;
  if (applied > 0) unchanged.above = epsilon_of_edit_[applied - 1];
  if (applied < log_.size()) {
    unchanged.up_to = epsilon_of_edit_[applied];
  } else if (exhausted_) {
    unchanged.up_to = std::numeric_limits<double>::infinity();
  }
  return unchanged;
}

}  // namespace trapeze
