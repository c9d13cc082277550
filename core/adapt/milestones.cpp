#include "core/adapt/milestones.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace trapeze {
namespace {

constexpr Milestone kUnknown = 0xffffffff;
// One in so many vertices has to be removed before loops are examined again, and a loop has to lose
// this fraction of its length before its milestones are noted again.
constexpr std::uint64_t kVerticesOfOneGone = 16;
constexpr double kWornShare = 1.0 / 16;

Milestone milestone_of(double along) {
  constexpr double kRound = 4294967296.0;
  const auto cells = static_cast<Milestone>(std::fmod(std::round(along), kRound));
  return std::clamp(cells, Milestone{1}, kUnknown - 1);
}

}  // namespace

void Milestones::begin(const TrapezoidalGraph& graph, const PriorityStack& stack) {
  graph_ = &graph;
  stack_ = &stack;
  removals_ = 0;
  is_first_ = true;
  milestones_.assign(graph.vertices().size(), kUnknown);
}

void Milestones::note(Level level, std::uint32_t base, std::vector<MilestoneNote>& notes) {
  const std::uint64_t removals = stack_->counts().removals;
  const std::uint64_t all = graph_->corners().size();
  const std::uint64_t left = all > removals ? all - removals : 0;
  if (!is_first_ && (removals - removals_) * kVerticesOfOneGone <= left) return;
  removals_ = removals;
  level_ = level;
  base_ = base;
  notes_ = &notes;
  count_visits();
  is_noted_.assign(graph_->corners().size(), 0);
  for (std::size_t i = 0; i < graph_->corners().size(); ++i) {
    const Corner& corner = graph_->corner(CornerId(i));
    if (corner.is_alive() && corner.prev.is_none()) note_from(CornerId(i));
  }
  for (std::size_t i = 0; i < graph_->corners().size(); ++i) {
    if (graph_->corner(CornerId(i)).is_alive() && is_noted_[CornerId(i)] == 0) {
      note_from(CornerId(i));
    }
  }
  is_first_ = false;
}

void Milestones::count_visits() {
  visits_.assign(graph_->vertices().size(), 0);
  for (const Corner& corner : graph_->corners()) {
    if (!corner.is_alive()) continue;
    std::uint8_t& visits = visits_[corner.vertex];
    visits = static_cast<std::uint8_t>(std::min(visits + 1, 2));
  }
}

/// A loop begins at the corner that is removed last, so that its beginning never changes.
void Milestones::note_from(CornerId first) {
  loop_.clear();
  CornerId c = first;
  do {
    is_noted_[c] = 1;
    loop_.push_back(c);
    c = graph_->corner(c).next;
  } while (!c.is_none() && c != first);
  if (!graph_->corner(first).prev.is_none()) {
    const auto goes_before = [this](CornerId a, CornerId b) {
      return std::pair(stack_->weight(a), graph_->corner(a).vertex) <
             std::pair(stack_->weight(b), graph_->corner(b).vertex);
    };
    std::rotate(loop_.begin(), std::max_element(loop_.begin(), loop_.end(), goes_before),
                loop_.end());
  }
  if (is_first_ || is_worn()) number_loop();
}

double Milestones::length_from(CornerId c) const {
  const Corner& corner = graph_->corner(c);
  const Point a = graph_->point(corner.vertex);
  const Point b = graph_->point(graph_->corner(corner.next).vertex);
  const double x = static_cast<double>(b.x) - a.x;
  const double y = static_cast<double>(b.y) - a.y;
  return std::sqrt(x * x + y * y);
}

bool Milestones::is_worn() const {
  double length = 0;
  double noted = 0;
  for (const CornerId c : loop_) {
    const Corner& corner = graph_->corner(c);
    if (corner.next.is_none()) continue;
    const Milestone from = milestones_[corner.vertex];
    const Milestone to = milestones_[graph_->corner(corner.next).vertex];
    const double drawn = length_from(c);
    length += drawn;
    if (from == 0 || to == 0) {
      noted += drawn;
      continue;
    }
    const Stretch stretch = stretch_between(from, to, drawn);
    if (!stretch.fits) return true;
    noted += std::abs(stretch.length);
  }
  return length < (1 - kWornShare) * noted;
}

bool Milestones::begins_anew(CornerId c) const {
  const Corner& corner = graph_->corner(c);
  return c == loop_.front() || corner.is_end() || visits_[corner.vertex] > 1;
}

void Milestones::number_loop() {
  double along = 0;
  for (const CornerId c : loop_) {
    if (begins_anew(c)) along = 0;
    const VertexId vertex = graph_->corner(c).vertex;
    const Milestone now = begins_anew(c) ? 0 : milestone_of(along);
    if (milestones_[vertex] != now) {
      milestones_[vertex] = now;
      notes_->push_back({base_ + vertex.value - 1, now, level_});
    }
    if (!graph_->corner(c).next.is_none()) along += length_from(c);
  }
}

}  // namespace trapeze
