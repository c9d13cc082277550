#include "bench/experiment/open_trapezoids.h"

#include <algorithm>

#include "bench/experiment/beyond_view.h"
#include "core/sweep/boundary.h"

namespace trapeze::experiment {
namespace {

// Fewer items than this are sorted and searched linearly.
constexpr std::size_t kFewSlots = 16;

constexpr Point point_of_key(std::uint64_t key) {
  const auto unbiased = [](std::uint64_t v) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(v) - 0x80000000u);
  };
  return {unbiased(key & 0xffffffff), unbiased(key >> 32)};
}

}  // namespace

void OpenTrapezoids::tessellate(const Rings& rings, std::uint32_t first, std::uint32_t last,
                                const Box& view, Boundary boundary, TrapezoidList& trapezoids) {
  const std::size_t size_before = trapezoids.size();
  collect(rings, first, last, view);
  if (sweep(view, boundary, trapezoids)) return;
  trapezoids.cut(size_before);
  tessellate_noded(rings, first, last, view, trapezoids);
}

void OpenTrapezoids::collect(const Rings& rings, std::uint32_t first, std::uint32_t last,
                             const Box& view) {
  edges_.clear();
  visits_.clear();
  crossing_.clear();
  for (std::uint32_t r = first; r < last; ++r) {
    const auto ring = rings[r];
    const auto base = static_cast<std::uint32_t>(edges_.size());
    const auto size = static_cast<std::uint32_t>(ring.size());
    for (std::uint32_t i = 0; i < size; ++i) {
      const Point a = ring[i];
      const Point b = ring[i + 1 < size ? i + 1 : 0];
      const Edge edge = is_above(a, b) ? Edge{a, b} : Edge{b, a};
      edges_.push_back(edge);
      if (view.min_y <= a.y && a.y <= view.max_y) {
        visits_.push_back({sweep_key(a), base + i, base + (i == 0 ? size : i) - 1});
      }
      if (edge.upper.y < view.min_y && edge.lower.y >= view.min_y) {
        crossing_.emplace_back(x_at(edge.upper, edge.lower, view.min_y), edge);
      }
    }
  }
}

/// Puts the edges that cross the top of the view on the sweep line.
bool OpenTrapezoids::start(const Box& view, Boundary boundary) {
  const auto is_left = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::sort(crossing_.begin(), crossing_.end(), is_left);
  status_.clear();
  for (const auto& [x, edge] : crossing_) status_.push_back({edge, view.min_y});
  if (boundary == Boundary::simple) return true;
  for (std::size_t i = 0; i < status_.size(); ++i) {
    if (!is_apart(i)) return false;
  }
  return true;
}

bool OpenTrapezoids::sweep(const Box& view, Boundary boundary, TrapezoidList& trapezoids) {
  const auto is_before = [](const Visit& a, const Visit& b) { return a.key < b.key; };
  std::sort(visits_.begin(), visits_.end(), is_before);
  if (!start(view, boundary)) return false;
  for (std::size_t begin = 0; begin < visits_.size();) {
    std::size_t end = begin + 1;
    while (end < visits_.size() && visits_[end].key == visits_[begin].key) ++end;
    if (!sweep_vertex(begin, end, boundary, view, trapezoids)) return false;
    begin = end;
  }
  close_intervals(0, status_.size(), view.max_y, view, trapezoids);
  return status_.size() % 2 == 0;
}

/// Writes the open trapezoids right of slots `begin` .. `end` - 1: the area between the first and
/// the second edge is inside, between the second and the third outside.
void OpenTrapezoids::close_intervals(std::size_t begin, std::size_t end, std::int32_t bottom,
                                     const Box& view, TrapezoidList& trapezoids) const {
  for (std::size_t i = begin + begin % 2; i < end && i + 1 < status_.size(); i += 2) {
    const Edge& left = status_[i].edge;
    const Edge& right = status_[i + 1].edge;
    trapezoids.append({status_[i].top, bottom, left.upper, left.lower, right.upper, right.lower},
                      view);
  }
}

bool OpenTrapezoids::sweep_vertex(std::size_t begin, std::size_t end, Boundary boundary,
                                  const Box& view, TrapezoidList& trapezoids) {
  const Point p = point_of_key(visits_[begin].key);
  starting_.clear();
  for (std::size_t i = begin; i < end; ++i) {
    for (const std::uint32_t e : {visits_[i].edge, visits_[i].edge_before}) {
      if (edges_[e].upper == p) starting_.push_back(edges_[e]);
    }
  }
  const std::size_t ending = 2 * (end - begin) - starting_.size();
  const std::size_t position = locate(p);
  if (position + ending > status_.size()) return false;
  for (std::size_t i = position; i < position + ending; ++i) {
    if (status_[i].edge.lower != p) return false;
  }
  close_intervals(position == 0 ? 0 : position - 1, position + ending, p.y, view, trapezoids);
  if (!replace(position, ending, p)) return false;
  if (boundary == Boundary::simple) return true;
  const std::size_t last = position + starting_.size();
  if (position > 0 && !is_apart(position - 1)) return false;
  return last == position || is_apart(last - 1);
}

/// The index of the first edge that does not pass p on the left.
std::size_t OpenTrapezoids::locate(Point p) const {
  const auto is_left = [p](const Slot& slot) {
    return orientation(slot.edge.upper, slot.edge.lower, p) < 0;
  };
  const auto found = status_.size() < kFewSlots
                         ? std::find_if_not(status_.begin(), status_.end(), is_left)
                         : std::partition_point(status_.begin(), status_.end(), is_left);
  return static_cast<std::size_t>(found - status_.begin());
}

/// Replaces `count` edges that end at p by the starting edges. False if two of these overlap.
bool OpenTrapezoids::replace(std::size_t position, std::size_t count, Point p) {
  const auto is_left = [p](const Edge& a, const Edge& b) {
    return orientation(p, a.lower, b.lower) < 0;
  };
  std::sort(starting_.begin(), starting_.end(), is_left);
  for (std::size_t i = 1; i < starting_.size(); ++i) {
    if (!is_left(starting_[i - 1], starting_[i])) return false;
  }
  const auto at = status_.begin() + static_cast<std::ptrdiff_t>(position);
  if (starting_.size() < count) {
    status_.erase(at, at + static_cast<std::ptrdiff_t>(count - starting_.size()));
  } else if (starting_.size() > count) {
    status_.insert(at, starting_.size() - count, Slot{});
  }
  for (std::size_t i = 0; i < starting_.size(); ++i) status_[position + i] = {starting_[i], p.y};
  if (position > 0) status_[position - 1].top = p.y;
  return true;
}

/// Whether the edge in slot `left` and the one right of it do not meet below the sweep line, except
/// at a shared end.
bool OpenTrapezoids::is_apart(std::size_t left) const {
  if (left + 1 >= status_.size()) return true;
  const Edge& west = status_[left].edge;
  const Edge& east = status_[left + 1].edge;
  if (west.lower == east.lower) return orientation(west.lower, west.upper, east.upper) != 0;
  return is_above(west.lower, east.lower) ? orientation(east.upper, east.lower, west.lower) > 0
                                          : orientation(west.upper, west.lower, east.lower) < 0;
}

void OpenTrapezoids::tessellate_noded(const Rings& rings, std::uint32_t first, std::uint32_t last,
                                      const Box& view, TrapezoidList& trapezoids) {
  ++noded_;
  noded_rings_.clear();
  append_with_short_cuts(rings, first, last, view, noded_rings_);
  if (!builder_.build(noded_rings_, graph_).built) return;
  for (const NodeId n : graph_.inside_nodes()) {
    const Node& node = graph_.node(n);
    const Edge left{graph_.point(graph_.edge(node.edge[kLeft]).end[kUp]),
                    graph_.point(graph_.edge(node.edge[kLeft]).end[kDown])};
    const Edge right{graph_.point(graph_.edge(node.edge[kRight]).end[kUp]),
                     graph_.point(graph_.edge(node.edge[kRight]).end[kDown])};
    trapezoids.append({graph_.point(node.end[kUp]).y, graph_.point(node.end[kDown]).y, left.upper,
                       left.lower, right.upper, right.lower},
                      view);
  }
}

}  // namespace trapeze::experiment
