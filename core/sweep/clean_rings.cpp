#include "core/sweep/clean_rings.h"

#include <algorithm>

namespace trapeze {
namespace {

/// Whether b is no corner of a boundary a, b, c: the boundary stays at b, or turns back on itself
/// there.
bool is_spike(Point a, Point b, Point c) {
  if (a == b || b == c || a == c) return true;
  if (orientation(a, b, c) != 0) return false;
  const std::int64_t dot = (std::int64_t{b.x} - a.x) * (std::int64_t{c.x} - b.x) +
                           (std::int64_t{b.y} - a.y) * (std::int64_t{c.y} - b.y);
  return dot < 0;
}

/// Cleans points[begin, end) in place and returns the end of the remaining points, which are at
/// least three or none.
std::size_t clean_ring(std::vector<Point>& points, std::size_t begin, std::size_t end) {
  std::size_t top = begin;  // points[begin, top) has no spike, except possibly at its two ends
  for (std::size_t i = begin; i < end; ++i) {
    const Point p = points[i];
    while (top >= begin + 2 && is_spike(points[top - 2], points[top - 1], p)) --top;
    if (top > begin && points[top - 1] == p) continue;
    points[top++] = p;
  }
  // The same across the seam, where the last point meets the first.
  std::size_t first = begin;
  for (bool changed = true; changed && top - first >= 3;) {
    changed = true;
    if (is_spike(points[top - 2], points[top - 1], points[first])) {
      --top;
    } else if (is_spike(points[top - 1], points[first], points[first + 1])) {
      ++first;
    } else {
      changed = false;
    }
  }
  if (top - first < 3) return begin;
  if (first != begin) {
    std::copy(points.begin() + static_cast<std::ptrdiff_t>(first),
              points.begin() + static_cast<std::ptrdiff_t>(top),
              points.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  return begin + (top - first);
}

}  // namespace

std::size_t clean_rings(Rings& rings) {
  std::size_t dropped = 0;
  std::size_t write = 0;
  std::size_t begin = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rings.ends.size(); ++i) {
    const std::size_t end = rings.ends[i];
    const std::size_t clean_end = clean_ring(rings.points, begin, end);
    if (clean_end == begin) {
      ++dropped;
    } else {
      if (write != begin) {
        std::copy(rings.points.begin() + static_cast<std::ptrdiff_t>(begin),
                  rings.points.begin() + static_cast<std::ptrdiff_t>(clean_end),
                  rings.points.begin() + static_cast<std::ptrdiff_t>(write));
      }
      write += clean_end - begin;
      rings.ends[kept++] = static_cast<std::uint32_t>(write);
    }
    begin = end;
  }
  rings.ends.resize(kept);
  rings.points.resize(write);
  return dropped;
}

}  // namespace trapeze
