#include "core/adaptable_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "core/fetch_ahead.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kNobody = 0xffffffff;

// How far ahead, in candidates, each step is taken: some hundred nanoseconds later it has come, and
// what came is still in the nearest cache.
constexpr std::size_t kCornerAhead = 24;
constexpr std::size_t kEdgesAhead = 16;
constexpr std::size_t kNodesAhead = 8;
constexpr std::size_t kNeighboursAhead = 4;

std::pair<VertexId, VertexId> longest_side(const TrapezoidalGraph& graph,
                                           const std::array<VertexId, 3>& triangle) {
  std::pair<VertexId, VertexId> longest;
  double greatest = -1;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point a = graph.point(triangle[i]);
    const Point b = graph.point(triangle[(i + 1) % 3]);
    const double length =
        std::hypot(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y);
    if (length > greatest) longest = {triangle[i], triangle[(i + 1) % 3]};
    greatest = std::max(greatest, length);
  }
  return longest;
}

}  // namespace

void PriorityStack::assign(const TrapezoidalGraph& graph, const GeneralizationOptions& options) {
  graph_ = &graph;
  options_ = options;
  const std::size_t count = graph.corners().size();
  weights_.assign(count, std::numeric_limits<double>::quiet_NaN());
  order_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isnan(weights_[CornerId(i)])) continue;
    ring_.clear();
    ring_corners_.clear();
    CornerId c(i);
    do {
      ring_.push_back(graph.point(graph.corner(c).vertex));
      ring_corners_.push_back(c);
      c = graph.corner(c).next;
    } while (c != CornerId(i));
    const auto ring_weights = ring_weights_.weigh(ring_, options.weights);
    for (std::size_t k = 0; k < ring_.size(); ++k) {
      weights_[ring_corners_[k]] = ring_weights[k];
      if (!std::isfinite(ring_weights[k])) continue;
      const CornerId corner = ring_corners_[k];
      order_.push_back({ring_weights[k], graph.corner(corner).vertex, corner});
    }
  }
  std::sort(order_.begin(), order_.end());
  position_ = 0;
  epsilon_ = 0;
  retries_.clear();
  state_.assign(count, State::ahead);
  waiting_first_.assign(graph.vertices().size(), kNobody);
  waiting_.clear();
  has_blocked_ = false;
  counts_ = {};
}

std::optional<CornerId> PriorityStack::next_candidate() {
  if (!retries_.empty()) {
    std::pop_heap(retries_.begin(), retries_.end(), std::greater<>());
    const CornerId c = retries_.back().corner;
    retries_.pop_back();
    return c;
  }
  if (position_ == order_.size()) return std::nullopt;
  return pop();
}

CornerId PriorityStack::pop() {
  const Candidate next = order_[position_++];
  epsilon_ = std::max(epsilon_, next.weight);
  if (position_ + kCornerAhead < order_.size()) {
    const auto ahead = [this](std::size_t distance) { return order_[position_ + distance]; };
    fetch(graph_->corners(), ahead(kCornerAhead).corner);
    fetch(waiting_first_, ahead(kCornerAhead).vertex);
    fetch(state_, ahead(kCornerAhead).corner);
    fetch_edges(*graph_, ahead(kEdgesAhead).corner);
    fetch_nodes(*graph_, ahead(kNodesAhead).corner);
    fetch_neighbours(*graph_, ahead(kNeighboursAhead).corner);
  }
  return next.corner;
}

std::optional<double> PriorityStack::remove_next(const TrapezoidalGraph& graph, EditLog& log) {
  Generalization generalization(graph, log);
  while (const auto candidate = next_candidate()) {
    const CornerId c = *candidate;
    if (!graph.corner(c).is_alive()) continue;  // went with its loop
    const Decision decision = decide_removal(graph, c, options_.topology);
    ++counts_.tests;
    counts_.walked += decision.walked;
    if (decision.removal == Removal::blocked) {
      has_blocked_ = true;
      wait_for(c, decision.blocker);
      continue;
    }
    const Corner gone = graph.corner(c);
    const VertexId prev = graph.corner(gone.prev).vertex;
    const VertexId next = graph.corner(gone.next).vertex;
    if (decision.removal == Removal::loop)
      last_side_ = longest_side(graph, {prev, gone.vertex, next});
    generalization.remove(c, decision.removal);
    ++counts_.removals;
    counts_.touched += log.touched_nodes().size();
    last_corner_ = c;
    last_removal_ = decision.removal;
    retry_waiting(gone.vertex);
    if (decision.removal == Removal::loop) {
      retry_waiting(prev);
      retry_waiting(next);
    } else {
      retry_if_blocked(gone.prev);
      retry_if_blocked(gone.next);
    }
    return epsilon_;
  }
  return std::nullopt;
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
  retries_.push_back({weights_[corner], graph_->corner(corner).vertex, corner});
  std::push_heap(retries_.begin(), retries_.end(), std::greater<>());
}

AdaptableGraph::AdaptableGraph(TrapezoidalGraph graph, const GeneralizationOptions& options)
    : graph_(std::move(graph)), log_(graph_) {
  stack_.assign(graph_, options);
}

void AdaptableGraph::adapt_to(double epsilon) {
  while (log_.applied() > 0 && epsilon_of_edit_[log_.applied() - 1] >= epsilon) log_.revert();
  while (log_.applied() < log_.size() && epsilon_of_edit_[log_.applied()] < epsilon) log_.apply();
  // The sequence goes on where it has been followed before; the next removal is known only once it
  // has been made, so one too many is made and taken back.
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
