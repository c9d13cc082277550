#include "core/grid/area_moments.h"

#include <algorithm>
#include <cmath>

namespace trapeze {
namespace {

Point rounded(double x, double y) {
  const auto cell = [](double v) {
    return static_cast<std::int32_t>(std::clamp(std::round(v), double{kGridMin}, double{kGridMax}));
  };
  return {cell(x), cell(y)};
}

/// The fraction, 0 to 1, of the way from (x, y), which lies in the box, to (x + dx, y + dy) that
/// lies in the box.
double share_within(const Box& box, double x, double y, double dx, double dy) {
  if (box.is_empty()) return 1;
  const auto share = [](double at, double way, double min, double max) {
    if (way == 0) return 1.0;
    return std::clamp(((way < 0 ? min : max) - at) / way, 0.0, 1.0);
  };
  return std::min(share(x, dx, box.min_x, box.max_x), share(y, dy, box.min_y, box.max_y));
}

}  // namespace

void AreaMoments::unite(const AreaMoments& other) {
  const double sum = area + other.area;
  if (sum <= 0) return;
  const double dx = other.x - x;
  const double dy = other.y - y;
  const double reduced = area * other.area / sum;
  xx += other.xx + reduced * dx * dx;
  xy += other.xy + reduced * dx * dy;
  yy += other.yy + reduced * dy * dy;
  x += dx * other.area / sum;
  y += dy * other.area / sum;
  area = sum;
  box.include(other.box);
}

Axis AreaMoments::axis() const {
  const double half_difference = (xx - yy) / 2;
  const double greatest = std::max(0.0, (xx + yy) / 2 + std::hypot(half_difference, xy));
  const double angle = std::atan2(xy, half_difference) / 2;
  // For a rectangle, this moment is the area times the squared length over 12.
  const double half_length = area > 0 ? std::sqrt(3 * greatest / area) : 0;
  const double dx = half_length * std::cos(angle);
  const double dy = half_length * std::sin(angle);
  const double backward = share_within(box, x, y, -dx, -dy);
  const double forward = share_within(box, x, y, dx, dy);
  return {rounded(x - backward * dx, y - backward * dy),
          rounded(x + forward * dx, y + forward * dy)};
}

bool AreaMoments::is_compact() const {
  constexpr double kOfRectangle = 144;  // fourth power of the area over the product of its moments
  constexpr double kMostRatio = 1.5;
  const double squared_area = area * area;
  return kOfRectangle * (xx * yy - xy * xy) <=
         kMostRatio * kMostRatio * squared_area * squared_area;
}

void BoundaryMoments::add(Point from, Point to) {
  box_.include(from);
  box_.include(to);
  const double ax = static_cast<double>(from.x) - origin_.x;
  const double ay = static_cast<double>(from.y) - origin_.y;
  const double bx = static_cast<double>(to.x) - origin_.x;
  const double by = static_cast<double>(to.y) - origin_.y;
  // For the triangle between the edge and the origin.
  const double doubled = ax * by - bx * ay;
  area_ += doubled;
  x_ += doubled * (ax + bx);
  y_ += doubled * (ay + by);
  xx_ += doubled * (ax * ax + ax * bx + bx * bx);
  xy_ += doubled * (2 * ax * ay + ax * by + bx * ay + 2 * bx * by);
  yy_ += doubled * (ay * ay + ay * by + by * by);
}

AreaMoments BoundaryMoments::sum() const {
  if (area_ == 0) return {0, static_cast<double>(origin_.x), static_cast<double>(origin_.y)};
  const double sign = area_ < 0 ? -1 : 1;
  const double area = sign * area_ / 2;
  const double x = sign * x_ / (6 * area);
  const double y = sign * y_ / (6 * area);
  return {area,
          origin_.x + x,
          origin_.y + y,
          std::max(0.0, sign * xx_ / 12 - area * x * x),
          sign * xy_ / 24 - area * x * y,
          std::max(0.0, sign * yy_ / 12 - area * y * y),
          box_};
}

}  // namespace trapeze
