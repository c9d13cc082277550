#include "core/sweep/meetings.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <functional>
#include <unordered_map>

#include "core/grid/for_each_in_parallel.h"
#include "core/sweep/sweep_slabs.h"

namespace trapeze {
namespace {

/// floor(a / b + 1/2) for b > 0.
Int128 round_half_up(Int128 a, Int128 b) {
  const Int128 n = 2 * a + b;
  const Int128 d = 2 * b;
  Int128 q = n / d;
  if (n % d < 0) --q;
  return q;
}

int sign(Int128 v) {
  return (v > 0) - (v < 0);
}

/// Where the lines of two segments cross, exactly: at the fraction num / den of the first one.
class CrossingPoint {
 public:
  CrossingPoint(const Segment& s, const Segment& t) : from_(s.first), to_(s.second) {
    // Along s, the orientation with respect to t changes linearly from one value to the other.
    const Int128 first = orientation(t.first, t.second, s.first);
    const Int128 second = orientation(t.first, t.second, s.second);
    num_ = first;
    den_ = first - second;
    if (den_ < 0) {
      num_ = -num_;
      den_ = -den_;
    }
  }

  /// Negative if it is above p in sweep order, positive if below, 0 if it is p.
  int compare(Point p) const {
    const int by_y = compare(from_.y, to_.y, p.y);
    return by_y != 0 ? by_y : compare(from_.x, to_.x, p.x);
  }

  Point rounded() const {
    const auto at = [this](std::int32_t a, std::int32_t b) {
      return static_cast<std::int32_t>(a +
                                       round_half_up((static_cast<Int128>(b) - a) * num_, den_));
    };
    return {at(from_.x, to_.x), at(from_.y, to_.y)};
  }

 private:
  int compare(std::int32_t a, std::int32_t b, std::int32_t c) const {
    return sign((static_cast<Int128>(b) - a) * num_ - (static_cast<Int128>(c) - a) * den_);
  }

  Point from_;
  Point to_;
  Int128 num_;
  Int128 den_;
};

/// The sweep over vertices [first, last) of a boundary, independent of the rest.
class MeetingSweep {
 public:
  /// `slot_of`, by edge, is shared by the slabs of a boundary: each slab uses the entries of the
  /// edges that begin in it.
  MeetingSweep(const Boundary& boundary, std::size_t most, VertexId first, VertexId last,
               LargeArray<std::uint32_t>& slot_of)
      : most_(most),
        boundary_(boundary),
        first_(first),
        last_(last),
        vertex_(first),
        slot_of_(slot_of) {
    order_.clear();
  }

  /// False if there are more than `most` meetings.
  bool run() {
    if (first_.value > 1) begin_below(edges_across(boundary_, first_));
    for (std::size_t i = first_.value; i < last_.value; ++i) {
      vertex_ = VertexId(i);
      if (!swap_what_has_crossed()) return false;
      if (!pass_vertex()) return false;
    }
    // Segments that have crossed since the last vertex must be in their new order where the next
    // slab begins.
    vertex_ = last_;
    return swap_what_has_crossed();
  }

  std::size_t count() const { return count_; }
  const std::vector<Point>& points() const { return points_; }

 private:
  using Order = SweepOrder<EdgeId>;
  using Slot = Order::Slot;

  /// Two neighbours that cross between the vertex before `due` and `due`.
  struct Crossing {
    VertexId due;
    EdgeId left;
    EdgeId right;
    friend auto operator<=>(const Crossing&, const Crossing&) = default;
  };

  Point point(VertexId v) const { return boundary_.vertices[v]; }
  Segment segment(EdgeId e) const {
    const Boundary::Ends ends = boundary_.edges[e];
    return {point(ends.upper), point(ends.lower)};
  }
  void begin_below(const std::vector<EdgeId>& across) {
    Slot last = Order::kFirst;
    for (const EdgeId e : across) {
      last = order_.insert_after(last, e);
      slot_of(e) = last;
    }
    for (Slot slot = order_.next(Order::kFirst); !is_end(slot); slot = order_.next(slot)) {
      expect_crossing(order_.prev(slot), slot);
    }
  }
  Slot& slot_of(EdgeId e) {
    return boundary_.edges[e].upper < first_ ? slot_across_[e.value] : slot_of_[e.value];
  }
  static bool is_end(Slot slot) { return slot == Order::kFirst || slot == Order::kLast; }

  // Any two segments that have crossed since the last vertex are in the wrong order now. While
  // there are any, some of them are neighbours, and these are known.
  bool swap_what_has_crossed() {
    while (!crossings_.empty() && crossings_.front().due <= vertex_) {
      std::pop_heap(crossings_.begin(), crossings_.end(), std::greater<>());
      const Crossing crossing = crossings_.back();
      crossings_.pop_back();
      const Slot left = slot_of(crossing.left);
      const Slot right = order_.next(left);
      if (is_end(right) || order_[right] != crossing.right) continue;  // no longer neighbours
      points_.push_back(CrossingPoint(segment(crossing.left), segment(crossing.right)).rounded());
      if (++count_ > most_) return false;
      place(crossing.right, left);
      place(crossing.left, right);
      expect_crossing(order_.prev(left), left);
      expect_crossing(right, order_.next(right));
    }
    return true;
  }

  void place(EdgeId e, Slot slot) {
    order_[slot] = e;
    slot_of(e) = slot;
  }

  /// Records the crossing of two neighbours, if they cross other than at a vertex.
  void expect_crossing(Slot left, Slot right) {
    if (is_end(left) || is_end(right)) return;
    const EdgeId a = order_[left];
    const EdgeId b = order_[right];
    const Boundary::Ends a_ends = boundary_.edges[a];
    const Boundary::Ends b_ends = boundary_.edges[b];
    if (a_ends.lower == b_ends.lower) return;
    const bool a_is_shorter = a_ends.lower < b_ends.lower;
    const bool do_cross =
        a_is_shorter ? side_of(point(b_ends.upper), point(b_ends.lower), point(a_ends.lower)) > 0
                     : side_of(point(a_ends.upper), point(a_ends.lower), point(b_ends.lower)) < 0;
    if (!do_cross) return;
    // The first vertex that is not above the crossing: between the present one and the end of one
    // of the segments.
    const CrossingPoint crossing(segment(a), segment(b));
    std::size_t from = vertex_.value;
    std::size_t to = (a_is_shorter ? a_ends : b_ends).lower.value;
    while (from < to) {
      const std::size_t middle = (from + to) / 2;
      if (crossing.compare(point(VertexId(middle))) > 0) {
        from = middle + 1;
      } else {
        to = middle;
      }
    }
    const VertexId due(from);
    if (crossing.compare(point(due)) == 0) return;  // found there
    crossings_.push_back({due, a, b});
    std::push_heap(crossings_.begin(), crossings_.end(), std::greater<>());
  }

  //     \   |   /      The segments that contain the vertex are a run of neighbours. Those that
  //   ---------v---    end here are removed. Those that start here are added to those that pass
  //       /    \ .     through, which may change their order.
  bool pass_vertex() {
    below_.clear();
    EdgeId ending;
    for (const EdgeId e : boundary_.edges_at(vertex_)) {
      if (boundary_.edges[e].lower == vertex_) {
        ending = e;
      } else {
        below_.push_back(e);
      }
    }
    const std::size_t starting = below_.size();
    Slot left = take_run(ending);
    if (below_.size() > starting) {
      points_.push_back(point(vertex_));
      count_ += below_.size() - starting;
      if (count_ > most_) return false;
    }
    sort_below();
    const Slot right = order_.next(left);
    if (below_.empty()) {
      expect_crossing(left, right);
      return true;
    }
    Slot last = left;
    for (const EdgeId e : below_) {
      last = order_.insert_after(last, e);
      slot_of(e) = last;
    }
    expect_crossing(left, order_.next(left));
    expect_crossing(last, right);
    return true;
  }

  /// Removes the segments that contain the vertex from the order, and appends those that do not end
  /// there to below_. Returns the slot left of them.
  Slot take_run(EdgeId ending) {
    const auto side = [this](EdgeId e) {
      const Segment s = segment(e);
      return side_of(s.first, s.second, point(vertex_));
    };
    Slot slot = ending.is_none() ? Order::kNoSlot : slot_of(ending);
    if (slot == Order::kNoSlot) {
      const Order::Location found = order_.locate(side);
      if (found.on == Order::kNoSlot) return found.left;
      slot = found.on;
    }
    Slot left = order_.prev(slot);
    while (!is_end(left) && side(order_[left]) == 0) left = order_.prev(left);
    for (slot = order_.next(left); !is_end(slot) && side(order_[slot]) == 0;
         slot = order_.next(left)) {
      const EdgeId e = order_[slot];
      if (boundary_.edges[e].lower != vertex_) below_.push_back(e);
      order_.remove(slot);
    }
    return left;
  }

  /// From left to right below the vertex; coinciding ones by number.
  void sort_below() {
    if (below_.size() < 2) return;
    const Point p = point(vertex_);
    std::sort(below_.begin(), below_.end(), [&](EdgeId a, EdgeId b) {
      const std::int64_t side =
          side_of(p, point(boundary_.edges[a].lower), point(boundary_.edges[b].lower));
      return side != 0 ? side > 0 : a < b;
    });
  }

  const std::size_t most_;
  std::size_t count_ = 0;
  const Boundary& boundary_;
  const VertexId first_;
  const VertexId last_;
  VertexId vertex_;
  Order order_;
  LargeArray<Slot>& slot_of_;                            // by edge
  std::unordered_map<std::uint32_t, Slot> slot_across_;  // of edges that begin above the slab
  std::vector<Crossing> crossings_;                      // a heap, those due first at the front
  std::vector<EdgeId> below_;
  std::vector<Point> points_;
};

}  // namespace

std::optional<std::vector<Point>> find_meetings(const std::vector<Segment>& segments,
                                                std::size_t most) {
  Boundary boundary;
  boundary.assign(segments);
  return find_meetings(boundary, most);
}

std::optional<std::vector<Point>> find_meetings(const Boundary& boundary, std::size_t most,
                                                unsigned threads) {
  LargeArray<std::uint32_t> slot_of(boundary.edges.size(), 0xffffffff);
  const std::vector<VertexId> firsts = cut_into_slabs(boundary, threads);
  std::deque<MeetingSweep> slabs;
  for (std::size_t i = 0; i + 1 < firsts.size(); ++i) {
    slabs.emplace_back(boundary, most, firsts[i], firsts[i + 1], slot_of);
  }
  std::atomic<bool> is_over = false;
  for_each_in_parallel(slabs.size(), threads, [&](std::size_t i) {
    if (!slabs[i].run()) is_over = true;
  });
  std::size_t count = 0;
  std::vector<Point> points;
  for (const MeetingSweep& slab : slabs) {
    count += slab.count();
    points.insert(points.end(), slab.points().begin(), slab.points().end());
  }
  if (is_over || count > most) {
    // A meeting at the border of slabs may have been counted twice.
    return slabs.size() > 1 ? find_meetings(boundary, most) : std::nullopt;
  }
  std::sort(points.begin(), points.end(), is_above);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

}  // namespace trapeze
