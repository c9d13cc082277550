#include "core/adapt/adaptable_graph.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>
#include <utility>

#include "core/graph/fetch_ahead.h"
#include "core/grid/for_each_in_parallel.h"

namespace trapeze {
namespace {

/// Heap operations; the smallest candidate is first.
template <typename Candidate>
void add_to(std::vector<Candidate>& retries, const std::type_identity_t<Candidate>& candidate) {
  retries.push_back(candidate);
  std::push_heap(retries.begin(), retries.end(), std::greater<>());
}

template <typename Candidate>
Candidate pop_from(std::vector<Candidate>& retries) {
  std::pop_heap(retries.begin(), retries.end(), std::greater<>());
  const Candidate next = retries.back();
  retries.pop_back();
  return next;
}

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
  main_ = {};
  region_retries_.clear();
  put_off_.clear();
  next_put_off_ = 0;
  to_report_.reset();
  state_.assign(count, State::ahead);
  waiting_first_.assign(graph.vertices().size(), kNobody);
  waiting_.clear();
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
  is_in_place_.assign(weights_.size(), 0);
  gone_from_.assign(graph_->edges().size(), CornerId());
  next_gone_.assign(weights_.size(), CornerId());
}

std::optional<PriorityStack::Candidate> PriorityStack::next_candidate() {
  while (next_put_off_ < put_off_.size()) {
    if (const Candidate* retry = next_retry(); retry != nullptr && is_before_put_off(*retry)) {
      return pop_next_retry();
    }
    if (const auto next = next_put_off()) return next;
  }
  if (position_ > 0) main_.epsilon = std::max(main_.epsilon, order_[position_ - 1].weight);
  const bool has_more = position_ < order_.size();
  // A candidate that is already due precedes those still to come.
  const auto is_next = [&](const Candidate& retry) {
    return !has_more || retry.weight <= main_.epsilon || retry < order_[position_];
  };
  if (const Candidate* retry = next_retry(); retry != nullptr && is_next(*retry)) {
    return pop_next_retry();
  }
  if (!has_more) return std::nullopt;
  return pop();
}

bool PriorityStack::is_before_put_off(const Candidate& retry) const {
  const PutOff& next = put_off_[next_put_off_];
  const bool has_begun = next_put_off_ > 0 && put_off_[next_put_off_ - 1].key == next.key;
  if (has_begun) return retry < next.at;
  return retry.weight <= main_.epsilon || retry < next.key;
}

/// Returns the next candidate to try. None if the item was something else to do.
std::optional<PriorityStack::Candidate> PriorityStack::next_put_off() {
  const PutOff next = put_off_[next_put_off_++];
  main_.epsilon = std::max(main_.epsilon, next.key.weight);
  if (next.what == PutOff::What::to_retry) {
    retry_if_blocked(main_, next.corner);
    return std::nullopt;
  }
  if (next.what == PutOff::What::to_report) to_report_ = next;
  return Candidate{next.key.weight, {}, next.corner};
}

/// One of the edges of a triangular loop, and the side on which its inside lies.
LostLoop PriorityStack::lost_loop_at(CornerId c) const {
  const TriangleLoop loop = triangle_loop_at(*graph_, c);
  const Edge& edge = graph_->edge(loop.long_edge);
  return {loop.long_edge, loop.side, edge.face[loop.side], edge.face[opposite(loop.side)]};
}

PriorityStack::Candidate PriorityStack::pop_retry(Lane& lane) {
  const Candidate next = pop_from(lane.retries);
  lane.epsilon = std::max(lane.epsilon, next.weight);
  return next;
}

/// The next corner or region to be tried again; null if there is none.
const PriorityStack::Candidate* PriorityStack::next_retry() const {
  if (region_retries_.empty()) return main_.retries.empty() ? nullptr : &main_.retries.front();
  if (main_.retries.empty()) return &region_retries_.front();
  return &std::min(main_.retries.front(), region_retries_.front());
}

PriorityStack::Candidate PriorityStack::pop_next_retry() {
  if (!is_region(next_retry()->corner)) return pop_retry(main_);
  const Candidate next = pop_from(region_retries_);
  main_.epsilon = std::max(main_.epsilon, next.weight);
  return next;
}

PriorityStack::Candidate PriorityStack::pop() {
  const Candidate next = order_[position_++];
  main_.epsilon = std::max(main_.epsilon, next.weight);
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

void PriorityStack::enqueue(Lane& lane, const Candidate& candidate) {
  add_to(lane.retries, candidate);
}

std::optional<double> PriorityStack::remove_next([[maybe_unused]] const TrapezoidalGraph& graph,
                                                 EditLog& log) {
  assert(&graph == graph_);
  do {
    while (const auto candidate = next_candidate()) {
      if (to_report_) {
        report(*std::exchange(to_report_, std::nullopt), log);
        return main_.epsilon;
      }
      const bool has_gone = is_region(candidate->corner)
                                ? remove_region(region_of(candidate->corner), log)
                                : remove_corner(main_, candidate->corner, log);
      if (!has_gone) continue;
      ++main_.counts.removals;
      main_.counts.touched += log.touched_nodes().size();
      return main_.epsilon;
    }
  } while (main_.has_blocked && enqueue_anchors());
  return std::nullopt;
}

/// Reports a loop that was removed in a batch.
void PriorityStack::report(const PutOff& lost, EditLog& log) {
  if (graph_->is_coverage()) borders_.note_lost_loop(lost.loop);
  last_corner_ = lost.corner;
  last_removal_ = Removal::loop;
  log.begin();  // nothing remains to be changed
}

bool PriorityStack::remove_corner(Lane& lane, CornerId c, EditLog& log) {
  const TrapezoidalGraph& graph = *graph_;
  if (!graph.corner(c).is_alive()) return false;  // removed with its loop
  if (lane.batch != nullptr && !lane.batch->may_try(c)) return false;
  if (is_to_wait(lane, c)) return false;
  const Decision decision = decide_removal(graph, c, options_.topology);
  const Corner gone = graph.corner(c);
  const VertexId prev = graph.corner(gone.prev).vertex;
  const VertexId next = graph.corner(gone.next).vertex;
  const EdgeId edge_before = graph.corner(gone.prev).edge;
  if (lane.batch != nullptr && !lane.batch->carry_out(c, decision, log)) return false;
  ++lane.counts.tests;
  lane.counts.walked += decision.walked;
  if (decision.removal == Removal::blocked) {
    lane.has_blocked = true;
    wait_for(lane, c, decision.blocker);
    return false;
  }
  if (lane.batch == nullptr) {
    if (decision.removal == Removal::loop && graph.is_coverage()) {
      borders_.note_lost_loop(lost_loop_at(c));
    }
    Generalization(graph, log).remove(c, decision.removal);
    last_corner_ = c;
    last_removal_ = decision.removal;
  }
  retry_waiting(lane, gone.vertex);
  if (decision.removal == Removal::loop) {
    retry_waiting(lane, prev);
    retry_waiting(lane, next);
    return true;
  }
  if (graph.is_coverage()) note_joined(gone, c, edge_before);
  retry_if_blocked(lane, gone.prev);
  retry_if_blocked(lane, gone.next);
  return true;
}

/// In a coverage, after the removal of a corner; `edge_before` led to it.
void PriorityStack::note_joined(const Corner& gone, CornerId corner, EdgeId edge_before) {
  const EdgeId joined = graph_->corner(gone.prev).edge;
  const EdgeId other = joined == edge_before ? gone.edge : edge_before;
  borders_.note_joined(other, joined, gone.prev);
  // Two circular lists are joined by exchanging the successors of one element of each.
  next_gone_[corner] = corner;
  for (const EdgeId edge : {joined, other}) {
    if (!gone_from_[edge].is_none()) {
      std::swap(next_gone_[corner], next_gone_[gone_from_[edge]]);
    }
  }
  gone_from_[joined] = corner;
  if (is_in_place_[corner] == 0) return;
  is_in_place_[gone.prev] = 1;
  is_in_place_[gone.next] = 1;
}

/// A corner that is weighed in place is weighed whenever it is popped.
bool PriorityStack::is_to_wait(Lane& lane, CornerId c) {
  if (!graph_->is_coverage() || is_in_place_[c] == 0) return false;
  weights_[c] = weight_in_place(c);
  if (weights_[c] <= lane.epsilon) return false;
  state_[c] = State::queued;
  enqueue(lane, {weights_[c], graph_->corner(c).vertex, c});
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

/// Assigns weights to the remaining anchors of rings; false if there are none.
bool PriorityStack::enqueue_anchors() {
  bool has_any = false;
  for (std::size_t i = 0; i < graph_->corners().size(); ++i) {
    const CornerId c(i);
    const Corner& corner = graph_->corner(c);
    if (!corner.is_alive() || corner.is_end() || std::isfinite(weights_[c])) continue;
    weights_[c] = weight_in_place(c);
    state_[c] = State::queued;
    enqueue(main_, {weights_[c], corner.vertex, c});
    has_any = true;
  }
  return has_any;
}

bool PriorityStack::remove_region(RegionId region, EditLog& log) {
  const double weight = borders_.weight(region);
  if (!std::isfinite(weight)) return false;
  if (weight > main_.epsilon) {
    requeue_region(region, weight);
    return false;
  }
  const RegionBorders::United united = borders_.remove(region, log);
  if (united.empty()) return false;
  last_removal_ = Removal::region;
  for (const VertexId v : borders_.changed()) retry_waiting(main_, v);
  for (const CornerId c : borders_.dissolved()) {
    if (!graph_->corner(c).is_alive()) continue;  // removed with a region that was united later
    is_in_place_[c] = 1;
    is_to_wait(main_, c);
    if (state_[c] != State::queued) {
      state_[c] = State::queued;
      enqueue(main_, {weights_[c], graph_->corner(c).vertex, c});
    }
  }
  requeue_united(united);
  return true;
}

/// A united region is not weighed again before it is popped. For a block, the known weight of any
/// of its parts is enough.
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
  add_to(region_retries_, {weight, {}, corner_for(region)});
}

void PriorityStack::wait_for(Lane& lane, CornerId corner, VertexId blocker) {
  state_[corner] = State::blocked;
  if (lane.batch != nullptr) return lane.batch->wait_for(corner, blocker);
  waiting_.push_back({corner, waiting_first_[blocker]});
  waiting_first_[blocker] = static_cast<std::uint32_t>(waiting_.size() - 1);
}

void PriorityStack::retry_waiting(Lane& lane, VertexId gone) {
  if (lane.batch != nullptr) return lane.batch->retry_waiting(gone);
  std::uint32_t i = std::exchange(waiting_first_[gone], kNobody);
  for (; i != kNobody; i = waiting_[i].next) retry_if_blocked(main_, waiting_[i].corner);
}

void PriorityStack::retry_if_blocked(Lane& lane, CornerId corner) {
  if (state_[corner] != State::blocked || !graph_->corner(corner).is_alive()) return;
  state_[corner] = State::queued;
  enqueue(lane, {weights_[corner], graph_->corner(corner).vertex, corner});
}

AdaptableGraph::AdaptableGraph(TrapezoidalGraph graph, const GeneralizationOptions& options,
                               const MergePlan* plan)
    : graph_(std::move(graph)), log_(graph_) {
  stack_.assign(graph_, options, 1, plan);
}

void AdaptableGraph::adapt_to(double epsilon) {
  while (log_.applied() > 0 && epsilon_of_edit_[log_.applied() - 1] >= epsilon) log_.revert();
  while (log_.applied() < log_.size() && epsilon_of_edit_[log_.applied()] < epsilon) log_.apply();
  // The sequence continues where it ended before. The tolerance of the next removal is known only
  // once it has been made, so one removal too many is made and reverted.
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
