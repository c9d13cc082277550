// The boundary of one feature on the grid, as read from its source: any number of closed rings.
//
// Nothing is assumed about orientation, nesting or validity: inside is even-odd over all rings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/item_count.h"

namespace trapeze {

/// Rings one after another in one array. The first point is not repeated at the end of a ring.
struct Rings {
  std::vector<Point> points;
  std::vector<std::uint32_t> ends;  // ring i is points[ends[i - 1]] .. points[ends[i] - 1]

  std::size_t size() const { return ends.size(); }
  bool empty() const { return ends.empty(); }
  std::span<const Point> operator[](std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : ends[i - 1];
    return std::span<const Point>(points).subspan(begin, ends[i] - begin);
  }
  void clear() {
    points.clear();
    ends.clear();
  }
  /// Throws like close_ring().
  void add(std::span<const Point> ring) {
    points.insert(points.end(), ring.begin(), ring.end());
    close_ring();
  }
  /// Ends the ring that consists of the points appended to `points` since the last one. Throws
  /// std::length_error if there are more points than 32 bits can count.
  void close_ring() {
    require_countable(points.size(), "vertices of rings");
    ends.push_back(static_cast<std::uint32_t>(points.size()));
  }

  friend bool operator==(const Rings&, const Rings&) = default;
};

}  // namespace trapeze
