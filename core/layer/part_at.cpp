#include "core/layer/part_at.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <span>
#include <vector>

#include "core/grid/ring_box.h"

namespace trapeze {
namespace {

/// Like trapezoids: points on the left side and on the top belong to the area.
bool holds(std::span<const Point> ring, Point point) {
  bool is_inside = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Point upper = ring[i];
    Point lower = ring[i + 1 == ring.size() ? 0 : i + 1];
    if (upper.y > lower.y) std::swap(upper, lower);
    if (point.y < upper.y || point.y >= lower.y) continue;
    if (orientation(upper, lower, point) <= 0) is_inside = !is_inside;
  }
  return is_inside;
}

/// Squared, in cells.
double distance_to_edge(Point a, Point b, Point point) {
  const double dx = static_cast<double>(b.x) - a.x;
  const double dy = static_cast<double>(b.y) - a.y;
  const double px = static_cast<double>(point.x) - a.x;
  const double py = static_cast<double>(point.y) - a.y;
  const double length = dx * dx + dy * dy;
  const double along = length > 0 ? std::clamp((px * dx + py * dy) / length, 0.0, 1.0) : 0.0;
  const double x = px - along * dx;
  const double y = py - along * dy;
  return x * x + y * y;
}

double distance_to(std::span<const Point> ring, Point point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point next = ring[i + 1 == ring.size() ? 0 : i + 1];
    nearest = std::min(nearest, distance_to_edge(ring[i], next, point));
  }
  return nearest;
}

/// The boxes of the rings that contain the point, the innermost first: the rings are nested.
std::vector<Box> boxes_around(const Rings& rings, Point point) {
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (holds(rings[i], point)) boxes.push_back(box_of(rings[i]));
  }
  std::ranges::sort(boxes, {}, area_of);
  return boxes;
}

std::size_t nearest_ring(const Rings& rings, Point point) {
  std::size_t nearest = 0;
  double nearest_distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const double distance = distance_to(rings[i], point);
    if (distance >= nearest_distance) continue;
    nearest_distance = distance;
    nearest = i;
  }
  return nearest;
}

}  // namespace

Box part_at(const Rings& rings, Point point) {
  if (rings.empty()) return {};
  const std::vector<Box> around = boxes_around(rings, point);
  if (around.size() % 2 == 1) return around.front();
  // The point is outside, or in a hole. In a hole the ring around it counts, unless an island in it
  // is nearer.
  const auto ring = rings[nearest_ring(rings, point)];
  const bool is_hole = around.size() > 1 && holds(ring, point);
  return is_hole ? around[1] : box_of(ring);
}

}  // namespace trapeze
