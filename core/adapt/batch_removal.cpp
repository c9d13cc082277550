#include "core/adapt/batch_removal.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <utility>

#include "core/graph/fetch_ahead.h"
#include "core/graph/generalization.h"
#include "core/grid/for_each_in_parallel.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kOfLane = 0x80000000;

// With fewer removals, starting threads is not worthwhile.
constexpr std::size_t kFewest = 2048;
constexpr std::size_t kFewestOfVertices = 256;  // at least one vertex in so many
constexpr std::size_t kLanesPerThread = 4;
constexpr std::size_t kMostLanes = 32;  // with more lanes, more removals are put off than threads
                                        // gain
constexpr std::size_t kFewestVerticesPerLane = 1024;
// Corners with more nodes along their edges are put off.
constexpr std::size_t kMostNodes = 64;

}  // namespace

void Held::assign(const TrapezoidalGraph& graph) {
  corners_.assign(graph.corners().size(), kFree);
  edges_.assign(graph.edges().size(), 0);
  vertices_.assign(graph.vertices().size(), 0);
}

std::uint8_t Held::state(CornerId c) const {
  return std::atomic_ref(corners_[c]).load(std::memory_order_relaxed);
}

void Held::hold(CornerId c) {
  std::uint8_t was = kFree;
  std::atomic_ref(corners_[c]).compare_exchange_strong(was, kAlone, std::memory_order_relaxed);
}

void Held::hold_whole(CornerId c) {
  std::atomic_ref(corners_[c]).store(kWhole, std::memory_order_relaxed);
}

BatchLane::BatchLane(PriorityStack& stack, TrapezoidalGraph& graph, Held& held)
    : stack_(stack), graph_(graph), held_(held) {}

void BatchLane::begin(VertexId first, VertexId last) {
  reach_ = held_.reach(first, last);
  lane_ = {};
  lane_.epsilon = stack_.main_.epsilon;
  lane_.batch = this;
  due_.clear();
  position_ = 0;
  leading_out_.clear();
  put_off_.clear();
}

bool BatchLane::has(CornerId c) const {
  const auto has_vertex = [this](CornerId corner) { return has(graph_.corner(corner).vertex); };
  const Corner& corner = graph_.corner(c);
  return has_vertex(c) && has_vertex(corner.prev) && has_vertex(corner.next);
}

void BatchLane::gather(std::span<const Candidate> due) {
  constexpr std::size_t kAhead = 16;
  for (const Candidate& candidate : due) {
    if (has(candidate.vertex)) due_.push_back(candidate);
  }
  for (std::size_t i = 0; i < due_.size(); ++i) {
    if (i + 2 * kAhead < due_.size()) fetch(graph_.corners(), due_[i + 2 * kAhead].corner);
    if (i + kAhead < due_.size()) fetch_edges(graph_, due_[i + kAhead].corner);
    const CornerId c = due_[i].corner;
    if (graph_.corner(c).is_alive() && !has(c)) leading_out_.push_back(c);
  }
}

void BatchLane::take(const Candidate& retry) {
  PriorityStack::enqueue(lane_, retry);
}

/// Once the corner is removed, its neighbours and the corners that wait for it are tried again; if
/// it is the last one of a loop, its neighbours are removed with it. So all of these are held too.
void BatchLane::hold(CornerId c) {
  to_hold_.assign(1, c);
  while (!to_hold_.empty()) {
    c = to_hold_.back();
    to_hold_.pop_back();
    if (held_.has_whole(c)) continue;
    held_.hold_whole(c);
    const Corner& corner = graph_.corner(c);
    held_.hold(corner.edge);
    held_.hold(graph_.corner(corner.prev).edge);
    hold_vertex(corner.vertex);
    for (const CornerId beside : {corner.prev, corner.next}) {
      hold_vertex(graph_.corner(beside).vertex);
      if (stack_.state_[beside] == PriorityStack::State::blocked) to_hold_.push_back(beside);
    }
  }
}

void BatchLane::hold_vertex(VertexId v) {
  if (held_.has(v)) return;
  held_.hold(v);
  for (std::uint32_t i = stack_.waiting_first_[v]; i != kNobody; i = waiting_at(i).next) {
    const CornerId c = waiting_at(i).corner;
    const bool is_blocked = stack_.state_[c] == PriorityStack::State::blocked;
    if (is_blocked && graph_.corner(c).is_alive()) {
      to_hold_.push_back(c);
    } else {
      held_.hold(c);
    }
  }
}

const BatchLane::Waiting& BatchLane::waiting_at(std::uint32_t i) const {
  return (i & kOfLane) != 0 ? waiting_[i & ~kOfLane] : stack_.waiting_[i];
}

void BatchLane::run(const Candidate* end, const Removed& removed) {
  EditLog log(graph_);
  log.confine_to(reach_);
  while (const auto candidate = next(end)) {
    if (!stack_.remove_corner(lane_, candidate->corner, log)) continue;
    ++lane_.counts.removals;
    lane_.counts.touched += log.touched_nodes().size();
    removed(log);
    log.forget();
  }
}

std::optional<BatchLane::Candidate> BatchLane::next(const Candidate* end) {
  const Candidate* ahead = position_ < due_.size() ? &due_[position_] : end;
  if (!lane_.retries.empty()) {
    const Candidate& retry = lane_.retries.front();
    const bool is_due = retry.weight <= lane_.epsilon;
    if (is_due || (ahead != nullptr && retry < *ahead)) {
      at_ = PriorityStack::pop_retry(lane_);
      if (!is_due) {
        key_ = at_;
        at_ = PriorityStack::kFirst;
        return key_;
      }
      return at_;
    }
  }
  if (position_ == due_.size()) return std::nullopt;
  key_ = due_[position_++];
  at_ = PriorityStack::kFirst;
  lane_.epsilon = std::max(lane_.epsilon, key_.weight);
  if (position_ + kCornerAhead < due_.size()) fetch_candidates();
  return key_;
}

void BatchLane::fetch_candidates() const {
  const auto fetch_for = [this](std::size_t distance, const auto& fetch_step) {
    const CornerId c = due_[position_ + distance].corner;
    if (!held_.has(c)) fetch_step(graph_, c);
  };
  fetch_for(kCornerAhead, [&](const TrapezoidalGraph& graph, CornerId c) {
    fetch(graph.corners(), c);
    fetch(stack_.waiting_first_, due_[position_ + kCornerAhead].vertex);
    fetch(stack_.state_, c);
  });
  fetch_for(kEdgesAhead, fetch_edges);
  fetch_for(kNodesAhead, fetch_nodes);
  fetch_for(kNeighboursAhead, fetch_neighbours);
}

bool BatchLane::may_try(CornerId c) {
  if (!held_.has(c) && is_free(c)) return true;
  put_off(c, PutOff::What::to_try);
  return false;
}

/// Whether nothing that the removal of the corner reads is held.
bool BatchLane::is_free(CornerId c) const {
  const Corner& corner = graph_.corner(c);
  std::size_t nodes = 0;
  return !held_.has(corner.vertex) && is_free(corner.edge, nodes) &&
         is_free(graph_.corner(corner.prev).edge, nodes);
}

bool BatchLane::is_free(EdgeId e, std::size_t& nodes) const {
  if (held_.has(e)) return false;
  const Edge& edge = graph_.edge(e);
  for (const Side s : {kLeft, kRight}) {
    for (NodeId n = edge.extreme[s][kUp]; !n.is_none();
         n = graph_.node(n).link[opposite(s)][kDown]) {
      const Node& node = graph_.node(n);
      if (++nodes > kMostNodes || held_.has(node.edge[s]) || held_.has(node.end[kUp]) ||
          held_.has(node.end[kDown])) {
        return false;
      }
    }
  }
  return true;
}

/// Like is_free(), for the whole triangle, given one of its corners that is free.
bool BatchLane::is_free_loop(CornerId c) const {
  std::size_t nodes = 0;
  return is_free(graph_.corner(graph_.corner(c).next).edge, nodes);
}

bool BatchLane::carry_out(CornerId c, const Decision& decision, EditLog& log) {
  if (decision.removal == Removal::blocked) return true;
  const bool is_loop = decision.removal == Removal::loop;
  if (!is_loop || is_free_loop(c)) {
    PutOff lost{key_, at_, c, PutOff::What::to_report};
    if (is_loop) lost.loop = stack_.lost_loop_at(c);
    try {
      Generalization(graph_, log).remove(c, decision.removal);
      if (is_loop) put_off_.push_back(lost);
      return true;
    } catch (const EditLog::OutOfReach&) {
      log.take_back();
    }
  }
  put_off(c, PutOff::What::to_try);
  return false;
}

void BatchLane::put_off(CornerId c, PutOff::What what) {
  put_off_.push_back({key_, at_, c, what});
  if (what == PutOff::What::to_try) hold(c);
}

void BatchLane::wait_for(CornerId corner, VertexId blocker) {
  std::uint32_t& first = stack_.waiting_first_[blocker];
  const auto number = static_cast<std::uint32_t>(waiting_.size());
  waiting_.push_back({corner, first});
  blockers_.push_back(blocker);
  first = number | kOfLane;
}

void BatchLane::retry_waiting(VertexId gone) {
  std::uint32_t i = std::exchange(stack_.waiting_first_[gone], kNobody);
  for (; i != kNobody; i = waiting_at(i).next) {
    const CornerId c = waiting_at(i).corner;
    if (held_.has(c)) {
      put_off(c, PutOff::What::to_retry);
    } else {
      stack_.retry_if_blocked(lane_, c);
    }
  }
}

void BatchLane::end(std::vector<PutOff>& put_off) {
  put_off.insert(put_off.end(), put_off_.begin(), put_off_.end());
  const auto base = static_cast<std::uint32_t>(stack_.waiting_.size());
  const auto number_in_stack = [base](std::uint32_t i) {
    return i != kNobody && (i & kOfLane) != 0 ? base + (i & ~kOfLane) : i;
  };
  for (const Waiting& waiting : waiting_) {
    stack_.waiting_.push_back({waiting.corner, number_in_stack(waiting.next)});
  }
  for (const VertexId blocker : blockers_) {
    std::uint32_t& first = stack_.waiting_first_[blocker];
    if (first < base || first == kNobody || (first & kOfLane) == 0) continue;
    first = number_in_stack(first);
  }
  waiting_.clear();
  blockers_.clear();
  for (const Candidate& retry : lane_.retries) PriorityStack::enqueue(stack_.main_, retry);
  PriorityStack::Counts& counts = stack_.main_.counts;
  counts.removals += lane_.counts.removals;
  counts.tests += lane_.counts.tests;
  counts.walked += lane_.counts.walked;
  counts.touched += lane_.counts.touched;
  counts.at_once += lane_.counts.removals;
  stack_.main_.has_blocked |= lane_.has_blocked;
}

BatchRemoval::BatchRemoval(PriorityStack& stack, TrapezoidalGraph& graph, unsigned threads)
    : stack_(stack), graph_(graph), threads_(threads) {
  const std::size_t most = std::min(kMostLanes, graph.vertex_count() / kFewestVerticesPerLane);
  const std::size_t lanes = threads > 1 ? std::min(kLanesPerThread * threads, most) : 0;
  for (std::size_t i = 0; i < lanes; ++i) {
    lanes_.push_back(std::make_unique<BatchLane>(stack, graph, held_));
  }
}

BatchRemoval::~BatchRemoval() = default;

bool BatchRemoval::run(Level level, const Removed& removed) {
  const PriorityStack::Candidate* retry = stack_.next_retry();
  const bool is_between = stack_.next_put_off_ == stack_.put_off_.size() &&
                          (retry == nullptr || retry->weight > stack_.main_.epsilon);
  if (lanes_.size() < 2 || !is_between || stack_.position_ < looked_at_) return false;
  const std::size_t begin = stack_.position_;
  const std::size_t end = end_of_batch(level);
  if (end < begin + std::max(kFewest, graph_.vertex_count() / kFewestOfVertices)) {
    looked_at_ = std::max(end, begin + 1);
    return false;
  }
  gather(end);
  const PriorityStack::Candidate* next = end < stack_.order_.size() ? &stack_.order_[end] : nullptr;
  gather_retries(next);
  for_each_in_parallel(lanes_.size(), threads_, [&](std::size_t i) {
    lanes_[i]->run(next, [&](const EditLog& log) { removed(i, log); });
  });
  stack_.put_off_.clear();
  stack_.next_put_off_ = 0;
  note_work();
  for (const auto& lane : lanes_) lane->end(stack_.put_off_);
  std::stable_sort(stack_.put_off_.begin(), stack_.put_off_.end(),
                   [](const auto& a, const auto& b) { return a.key < b.key; });
  stack_.position_ = end;
  return true;
}

/// Assumes that lanes are taken one after another by whichever thread is free.
void BatchRemoval::note_work() const {
  std::vector<std::uint64_t> by_thread(threads_, 0);
  std::uint64_t all = 0;
  for (const auto& lane : lanes_) {
    *std::ranges::min_element(by_thread) += lane->work();
    all += lane->work();
  }
  stack_.main_.counts.beside += all - *std::ranges::max_element(by_thread);
}

/// Gives each lane its candidates due up to `end`, and holds everything that may reach into two
/// slabs.
void BatchRemoval::gather(std::size_t end) {
  held_.assign(graph_);
  const std::span<const PriorityStack::Candidate> due =
      std::span(stack_.order_).subspan(stack_.position_, end - stack_.position_);
  const auto vertices = static_cast<std::uint64_t>(graph_.vertex_count());
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    lanes_[i]->begin(VertexId(1 + vertices * i / lanes_.size()),
                     VertexId(vertices * (i + 1) / lanes_.size()));
  }
  std::vector<std::vector<CornerId>> blocked(lanes_.size());
  for_each_in_parallel(lanes_.size(), threads_, [&](std::size_t i) {
    lanes_[i]->gather(due);
    collect_blocked(i, blocked[i]);
  });
  for (const auto& lane : lanes_) {
    for (const CornerId c : lane->leading_out()) lane->hold(c);
  }
  for (const auto& some : blocked) {
    for (const CornerId c : some) lanes_.front()->hold(c);
  }
}

/// The retrials that may fall due before `end`, if there is one.
void BatchRemoval::gather_retries(const PriorityStack::Candidate* end) {
  using Candidate = PriorityStack::Candidate;
  std::vector<Candidate>& retries = stack_.main_.retries;
  const auto goes_to_a_lane = [&](const Candidate& retry) {
    if (end == nullptr || !(retry < *end)) return false;
    if (!graph_.corner(retry.corner).is_alive()) return false;
    if (leads_out(retry.corner)) {
      lanes_.front()->hold(retry.corner);
      return false;
    }
    lane_of(retry.vertex).take(retry);
    return true;
  };
  std::erase_if(retries, goes_to_a_lane);
  std::make_heap(retries.begin(), retries.end(), std::greater<>());
}

BatchLane& BatchRemoval::lane_of(VertexId v) const {
  return **std::ranges::find_if(lanes_, [v](const auto& lane) { return lane->has(v); });
}

bool BatchRemoval::leads_out(CornerId c) const {
  return !lane_of(graph_.corner(c).vertex).has(c);
}

/// The end of the level, or the place where the next region may be due.
std::size_t BatchRemoval::end_of_batch(Level level) const {
  using Candidate = PriorityStack::Candidate;
  const auto begin = stack_.order_.begin() + static_cast<std::ptrdiff_t>(stack_.position_);
  auto end = std::partition_point(begin, stack_.order_.end(), [level](const Candidate& candidate) {
    return level_above(candidate.weight) <= level;
  });
  const auto is_region = [this](const Candidate& c) { return stack_.is_region(c.corner); };
  const std::vector<Candidate>& regions = stack_.region_retries_;
  if (!regions.empty()) end = std::lower_bound(begin, end, regions.front());
  return static_cast<std::size_t>(std::find_if(begin, end, is_region) - stack_.order_.begin());
}

/// Collects, from one share of the corners, blocked ones that reach into two slabs.
void BatchRemoval::collect_blocked(std::size_t share, std::vector<CornerId>& leading_out) const {
  const std::size_t corners = stack_.state_.size();
  const std::size_t end = corners * (share + 1) / lanes_.size();
  for (std::size_t i = corners * share / lanes_.size(); i < end; ++i) {
    const CornerId c(i);
    const bool is_blocked = stack_.state_[c] == PriorityStack::State::blocked;
    if (is_blocked && graph_.corner(c).is_alive() && leads_out(c)) leading_out.push_back(c);
  }
}

}  // namespace trapeze
