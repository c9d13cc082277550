#include "core/adapt/farthest_vertex.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace trapeze {
namespace {

/// The smallest and the greatest of the measured values.
struct Range {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();

  void include(double value) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
};

/// The last of the successive corners of a side up to which each lies farther in the direction (x,
/// y) than the one before. A side turns by less than half a circle: if it recedes first, its
/// farthest corner is at one of its ends.
Point climb(std::span<const Point> side, std::int64_t x, std::int64_t y) {
  const auto goes_on = [&](std::size_t i) {
    return static_cast<Int128>(x) * (std::int64_t{side[i + 1].x} - side[i].x) +
               static_cast<Int128>(y) * (std::int64_t{side[i + 1].y} - side[i].y) >
           0;
  };
  std::size_t from = 0;
  std::size_t to = side.size() - 1;
  while (from < to) {
    const std::size_t middle = (from + to) / 2;
    if (goes_on(middle)) {
      from = middle + 1;
    } else {
      to = middle;
    }
  }
  return side[from];
}

}  // namespace

double SegmentDistance::squared_bound(std::span<const Point> hull) const {
  constexpr std::size_t kFewCorners = 32;
  if (hull.size() <= kFewCorners) {
    double bound = 0;
    for (const Point p : hull) bound = std::max(bound, squared(p));
    return bound;
  }
  const auto bottom = std::partition_point(hull.begin() + 1, hull.end(),
                                           [&](const Point& p) { return is_above(*(&p - 1), p); });
  const std::span<const Point> right(hull.begin(), bottom);
  const std::span<const Point> left(bottom - 1, hull.end());
  // The box around the hull whose sides are parallel to the segment. For a segment that is a point,
  // any direction will do.
  const bool is_point = squared_length_ == 0;
  const std::int64_t dx = is_point ? 1 : std::int64_t{b_.x} - a_.x;
  const std::int64_t dy = is_point ? 0 : std::int64_t{b_.y} - a_.y;
  Range along;
  Range across;
  const auto include = [&](Point p) {
    const double px = static_cast<double>(p.x) - a_.x;
    const double py = static_cast<double>(p.y) - a_.y;
    along.include(px * static_cast<double>(dx) + py * static_cast<double>(dy));
    across.include(static_cast<double>(dx) * py - static_cast<double>(dy) * px);
  };
  include(right.front());
  include(right.back());
  for (const auto& side : {right, left}) {
    for (const std::int64_t sign : {-1, 1}) {
      include(climb(side, sign * dx, sign * dy));
      include(climb(side, -sign * dy, sign * dx));
    }
  }
  const double beyond = std::max({0.0, -along.least, along.greatest - squared_length_});
  const double aside = std::max(-across.least, across.greatest);
  return (beyond * beyond + aside * aside) * (is_point ? 1 : inverse_);
}

struct FarthestVertex::Search {
  SegmentDistance distance;
  std::size_t piece_begin;
  std::size_t piece_end;
  Found best;
  std::size_t lap = 0;  // added to the index of a vertex in the ring to get its index in the piece

  std::size_t off_middle(std::size_t i) const { return std::max(i - piece_begin, piece_end - i); }
};

void FarthestVertex::assign(std::span<const Point> ring) {
  ring_ = ring;
  visits_ = 0;
  has_tree_ = false;
}

void FarthestVertex::build_tree() {
  const std::span<const Point> ring = ring_;
  std::size_t row = 0;
  for (std::size_t count = (ring.size() + kLeaf - 1) / kLeaf;; count = (count + 1) / 2, ++row) {
    if (rows_.size() == row) rows_.emplace_back();
    Row& hulls = rows_[row];
    hulls.corners.clear();
    hulls.ends.clear();
    for (std::size_t i = 0; i < count; ++i) {
      points_.clear();
      const auto take = [this](std::span<const Point> more) {
        points_.insert(points_.end(), more.begin(), more.end());
      };
      if (row == 0) {
        take(ring.subspan(i * kLeaf, std::min(kLeaf, ring.size() - i * kLeaf)));
      } else {
        take(rows_[row - 1][2 * i]);
        if (2 * i + 1 < rows_[row - 1].size()) take(rows_[row - 1][2 * i + 1]);
      }
      append_hull(hulls);
    }
    if (count == 1) break;
  }
  rows_.resize(row + 1);
  has_tree_ = true;
}

/// The hull of points_, which are sorted in the process: its right side from top to bottom, then
/// its left side from bottom to top (Andrew's monotone chain).
void FarthestVertex::append_hull(Row& row) {
  std::sort(points_.begin(), points_.end(), is_above);
  points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
  std::vector<Point>& hull = row.corners;
  const auto add_side = [&hull](auto begin, auto end) {
    const std::size_t first = hull.size();
    for (auto p = begin; p != end; ++p) {
      while (hull.size() >= first + 2 && orientation(hull[hull.size() - 2], hull.back(), *p) <= 0)
        hull.pop_back();
      hull.push_back(*p);
    }
    hull.pop_back();  // the other side begins with it
  };
  if (points_.size() == 1) {
    hull.push_back(points_.front());
  } else {
    add_side(points_.begin(), points_.end());
    add_side(points_.rbegin(), points_.rend());
  }
  row.ends.push_back(static_cast<std::uint32_t>(hull.size()));
}

FarthestVertex::Found FarthestVertex::find(std::size_t begin, std::size_t end) {
  Search search{SegmentDistance(at(begin), at(end)), begin, end, {begin + 1, -1}};
  if (end - begin <= kMostWithoutTree || visits_ < kVisitsBeforeTree * ring_.size()) {
    visits_ += end - begin;
    examine_all(begin + 1, end, search);
    return search.best;
  }
  if (!has_tree_) build_tree();
  const std::size_t n = ring_.size();
  search_range(std::min(begin + 1, n), std::min(end, n), 0, search);
  search_range(std::max(begin + 1, n) - n, std::max(end, n) - n, n, search);
  return search.best;
}

/// Examines the vertices [begin, end) of the piece.
void FarthestVertex::examine_all(std::size_t begin, std::size_t end, Search& search) const {
  Found& best = search.best;
  const std::size_t n = ring_.size();
  for (std::size_t i = begin; i < end; ++i) {
    const double squared = search.distance.squared(ring_[i < n ? i : i - n]);
    if (squared < best.squared) continue;
    if (squared > best.squared || wins_tie(i, search)) best = {i, squared};
  }
}

bool FarthestVertex::wins_tie(std::size_t i, const Search& search) const {
  const std::size_t off = search.off_middle(i);
  const std::size_t best_off = search.off_middle(search.best.vertex);
  if (off != best_off) return off < best_off;
  const Point p = at(i);
  const Point best = at(search.best.vertex);
  return p == best ? i < search.best.vertex : is_above(p, best);
}

/// Searches vertices [begin, end) of the ring. Leaves that are cut by the range are examined.
/// Between them, the nodes that fill the range are searched in order of the greatest distance that
/// their vertices may have. A node that extends beyond the range would promise distances of
/// vertices outside, and be searched in vain.
void FarthestVertex::search_range(std::size_t begin, std::size_t end, std::size_t lap,
                                  Search& search) const {
  if (begin >= end) return;
  std::size_t first = (begin + kLeaf - 1) / kLeaf;
  std::size_t last = end / kLeaf;
  if (first >= last) return examine_all(begin + lap, end + lap, search);
  examine_all(begin + lap, first * kLeaf + lap, search);
  examine_all(last * kLeaf + lap, end + lap, search);
  search.lap = lap;
  std::array<TreeNode, 2 * kMostRows> nodes;
  std::size_t count = 0;
  for (std::size_t row = 0; first < last; ++row, first /= 2, last /= 2) {
    if (first % 2 == 1) nodes[count++] = node(row, first++, search);
    if (last % 2 == 1) nodes[count++] = node(row, --last, search);
  }
  std::sort(nodes.begin(), nodes.begin() + count,
            [](const TreeNode& a, const TreeNode& b) { return a.bound > b.bound; });
  for (std::size_t i = 0; i < count; ++i) descend(nodes[i], search);
}

FarthestVertex::TreeNode FarthestVertex::node(std::size_t row, std::size_t index,
                                              const Search& search) const {
  const double bound = search.distance.squared_bound(rows_[row][index]);
  // Twice the greatest rounding error of a distance.
  constexpr double kRounding = 4e-6;
  return {row, index, bound + 2 * kRounding * std::sqrt(bound) + kRounding * kRounding};
}

void FarthestVertex::descend(const TreeNode& parent, Search& search) const {
  if (parent.bound < search.best.squared) return;
  if (parent.row == 0) {
    const std::size_t begin = parent.index * kLeaf + search.lap;
    return examine_all(begin, begin + kLeaf, search);
  }
  TreeNode nearer = node(parent.row - 1, 2 * parent.index, search);
  TreeNode farther = node(parent.row - 1, 2 * parent.index + 1, search);
  if (nearer.bound > farther.bound) std::swap(nearer, farther);
  descend(farther, search);
  descend(nearer, search);
}

}  // namespace trapeze
