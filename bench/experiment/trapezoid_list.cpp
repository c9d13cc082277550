#include "bench/experiment/trapezoid_list.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace trapeze::experiment {

double x_at(Point upper, Point lower, std::int32_t y) {
  const double slope =
      (static_cast<double>(lower.x) - upper.x) / (static_cast<double>(lower.y) - upper.y);
  return lower.x - slope * (static_cast<double>(lower.y) - y);
}

std::uint8_t size_of(const TrapezoidRecord& t) {
  const auto at = [](Point upper, Point lower, std::int32_t y) {
    if (upper.y == y) return static_cast<double>(upper.x);
    return x_at(upper, lower, y);
  };
  const double west =
      std::min(at(t.left_upper, t.left_lower, t.top), at(t.left_upper, t.left_lower, t.bottom));
  const double east =
      std::max(at(t.right_upper, t.right_lower, t.top), at(t.right_upper, t.right_lower, t.bottom));
  const auto width = static_cast<std::int64_t>(std::ceil(east) - std::floor(west));
  const std::int64_t height = std::int64_t{t.bottom} - t.top;
  return static_cast<std::uint8_t>(
      std::bit_width(static_cast<std::uint64_t>(std::max(width, height))));
}

void TrapezoidList::append(const TrapezoidRecord& t, const Box& view) {
  const bool is_in_view = t.top < t.bottom && t.top < view.max_y && t.bottom > view.min_y &&
                          std::min(t.left_upper.x, t.left_lower.x) <= view.max_x &&
                          std::max(t.right_upper.x, t.right_lower.x) >= view.min_x;
  if (!is_in_view) return;
  records.push_back(t);
  sizes.push_back(size_of(t));
}

void TrapezoidList::append_triangle(std::array<Point, 3> corners, const Box& view) {
  std::sort(corners.begin(), corners.end(), is_above);
  const auto [top, middle, bottom] = corners;
  const std::int64_t side = orientation(top, bottom, middle);
  const auto append_part = [&, a = top, b = bottom](Point upper, Point lower) {
    // The middle vertex lies east of the long side where the orientation is negative.
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
