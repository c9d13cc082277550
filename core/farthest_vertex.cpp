#include "core/farthest_vertex.h"

#include <algorithm>

namespace trapeze {

struct FarthestVertex::Search {
  SegmentDistance distance;
  std::size_t piece_begin;
  std::size_t piece_end;
  Found best;
  // Of the vertices of the tree that are asked for; `lap` is added to their index in the piece.
  std::size_t range_begin = 0;
  std::size_t range_end = 0;
  std::size_t lap = 0;

  std::size_t off_middle(std::size_t i) const { return std::max(i - piece_begin, piece_end - i); }
};

void FarthestVertex::assign(std::span<const Point> ring) {
  ring_ = ring;
  if (ring.size() <= kFew) return;
  std::size_t count = (ring.size() + kLeaf - 1) / kLeaf;
  std::size_t row = 0;
  for (;; ++row) {
    if (rows_.size() == row) rows_.emplace_back();
    rows_[row].assign(count, Box{});
    if (count == 1) break;
    count = (count + 1) / 2;
  }
  rows_.resize(row + 1);
  for (std::size_t i = 0; i < ring.size(); ++i) rows_[0][i / kLeaf].include(ring[i]);
  for (std::size_t r = 1; r < rows_.size(); ++r) {
    for (std::size_t i = 0; i < rows_[r - 1].size(); ++i) rows_[r][i / 2].include(rows_[r - 1][i]);
  }
}

FarthestVertex::Found FarthestVertex::find(std::size_t begin, std::size_t end) const {
  Search search{SegmentDistance(at(begin), at(end)), begin, end, {begin + 1, -1}};
  if (end - begin <= kFew) {
    for (std::size_t i = begin + 1; i < end; ++i) consider(i, search);
    return search.best;
  }
  const std::size_t n = ring_.size();
  search_range(std::min(begin + 1, n), std::min(end, n), 0, search);
  search_range(std::max(begin + 1, n) - n, std::max(end, n) - n, n, search);
  return search.best;
}

void FarthestVertex::consider(std::size_t i, Search& search) const {
  const double squared = search.distance.squared(at(i));
  Found& best = search.best;
  if (squared < best.squared) return;
  if (squared == best.squared) {
    const std::size_t off = search.off_middle(i);
    const std::size_t best_off = search.off_middle(best.vertex);
    if (off > best_off || (off == best_off && !is_above(at(i), at(best.vertex)))) return;
  }
  best = {i, squared};
}

void FarthestVertex::search_range(std::size_t begin, std::size_t end, std::size_t lap,
                                  Search& search) const {
  if (begin >= end) return;
  search.range_begin = begin;
  search.range_end = end;
  search.lap = lap;
  const std::size_t top = rows_.size() - 1;
  descend(top, 0, bound_of(top, 0, search), search);
}

/// No vertex in the box is farther away, not even by rounding; negative if none is asked for. The
/// distance is convex, so it is greatest at a corner, and it grows by a cell at least where the box
/// does: that outweighs all rounding.
double FarthestVertex::bound_of(std::size_t row, std::size_t index, const Search& search) const {
  const std::size_t vertices = kLeaf << row;
  if (index * vertices >= search.range_end || (index + 1) * vertices <= search.range_begin)
    return -1;
  const Box& b = rows_[row][index];
  double bound = 0;
  for (const std::int32_t x : {b.min_x - 1, b.max_x + 1}) {
    for (const std::int32_t y : {b.min_y - 1, b.max_y + 1}) {
      bound = std::max(bound, search.distance.squared({x, y}));
    }
  }
  return bound;
}

void FarthestVertex::descend(std::size_t row, std::size_t index, double bound,
                             Search& search) const {
  if (bound < search.best.squared || bound < 0) return;
  if (row == 0) {
    const std::size_t end = std::min((index + 1) * kLeaf, search.range_end);
    for (std::size_t i = std::max(index * kLeaf, search.range_begin); i < end; ++i) {
      consider(i + search.lap, search);
    }
    return;
  }
  const std::size_t left = 2 * index;
  const std::size_t right = left + 1;
  const double left_bound = bound_of(row - 1, left, search);
  const double right_bound = right < rows_[row - 1].size() ? bound_of(row - 1, right, search) : -1;
  if (left_bound >= right_bound) {
    descend(row - 1, left, left_bound, search);
    descend(row - 1, right, right_bound, search);
  } else {
    descend(row - 1, right, right_bound, search);
    descend(row - 1, left, left_bound, search);
  }
}

}  // namespace trapeze
