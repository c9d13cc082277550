#include "bench/experiment/trapezoid_list.h"

#include <algorithm>

namespace trapeze::experiment {

double x_at(Point upper, Point lower, std::int32_t y) {
  const double slope =
      (static_cast<double>(lower.x) - upper.x) / (static_cast<double>(lower.y) - upper.y);
  return lower.x - slope * (static_cast<double>(lower.y) - y);
}

void TrapezoidList::append(const TrapezoidRecord& t, const Box& view) {
  const bool is_in_view = t.top < t.bottom && t.top < view.max_y && t.bottom > view.min_y &&
                          std::min(t.left_upper.x, t.left_lower.x) <= view.max_x &&
                          std::max(t.right_upper.x, t.right_lower.x) >= view.min_x;
  if (!is_in_view) return;
  records.push_back(t);
}

void TrapezoidList::append_triangle(std::array<Point, 3> corners, const Box& view) {
  std::sort(corners.begin(), corners.end(), is_above);
  const auto [top, middle, bottom] = corners;
  const std::int64_t side = orientation(top, bottom, middle);
  const auto append_part = [&, a = top, b = bottom](Point upper, Point lower) {
    // The middle vertex is east of the long side if the orientation is negative.
    if (side < 0) {
      append({upper.y, lower.y, a, b, upper, lower}, view);
    } else {
      append({upper.y, lower.y, upper, lower, a, b}, view);
    }
  };
  if (side == 0) return;
  append_part(top, middle);
  append_part(middle, bottom);
}

}  // namespace trapeze::experiment
