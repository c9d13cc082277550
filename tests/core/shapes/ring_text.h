// Polygons as one line of text: points "x y" separated by commas, rings by semicolons.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "core/grid/rings.h"

namespace trapeze {

inline Rings rings_from_text(const std::string& text) {
  Rings rings;
  std::istringstream rings_in(text);
  for (std::string ring; std::getline(rings_in, ring, ';');) {
    std::istringstream points_in(ring);
    for (std::string point; std::getline(points_in, point, ',');) {
      std::istringstream in(point);
      Point p;
      in >> p.x >> p.y;
      EXPECT_FALSE(in.fail()) << "not a point: " << point;
      rings.points.push_back(p);
    }
    rings.close_ring();
  }
  return rings;
}

/// Twice the even-odd area of rings that do not cross: outer rings minus holes, by nesting depth.
/// Independent of the code under test; O(n^2).
inline std::int64_t doubled_area_of(std::span<const Point> ring) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point a = ring[i];
    const Point b = ring[(i + 1) % ring.size()];
    sum += std::int64_t{a.x} * b.y - std::int64_t{b.x} * a.y;
  }
  return sum < 0 ? -sum : sum;
}

/// Even-odd; the point lies between cells, so no vertex has its y. Independent of the code under
/// test.
inline bool is_inside(const Rings& rings, double x, double y) {
  bool is_inside = false;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const auto ring = rings[r];
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point a = ring[i];
      const Point b = ring[(i + 1) % ring.size()];
      if ((a.y < y) == (b.y < y)) continue;
      is_inside ^= x < a.x + (y - a.y) / (static_cast<double>(b.y) - a.y) * (b.x - a.x);
    }
  }
  return is_inside;
}

/// A star-shaped ring around a centre with random radii.
inline std::vector<Point> random_star(std::mt19937& random, Point centre, int points,
                                      double min_radius, double max_radius) {
  std::uniform_real_distribution<double> radius(min_radius, max_radius);
  std::vector<Point> ring;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * std::numbers::pi * i / points;
    const double r = radius(random);
    ring.push_back({centre.x + static_cast<std::int32_t>(std::lround(r * std::cos(angle))),
                    centre.y + static_cast<std::int32_t>(std::lround(r * std::sin(angle)))});
  }
  return ring;
}

}  // namespace trapeze
