// Families of polygons of any size: some like those of maps, others as hard as possible for a plane
// sweep or a recursive partitioning. Every polygon is a function of its size, the same on every
// machine and in every run, and its rings neither cross nor touch.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/grid/rings.h"

namespace trapeze {

/// Half of the side of the square that the families fill, in cells.
constexpr double kFamilyReach = 1 << 29;

inline Point cell_at(double x, double y) {
  return {static_cast<std::int32_t>(std::lround(x)), static_cast<std::int32_t>(std::lround(y))};
}

/// Numbers from [0, 1) in a fixed sequence; the distributions of the standard library depend on the
/// library.
class UnitNumbers {
 public:
  explicit UnitNumbers(std::uint32_t seed) : random_(seed) {}
  double next() { return static_cast<double>(random_()) / 4294967296.0; }

 private:
  std::mt19937 random_;
};

/// A building in any direction: one of five plans with right angles, 4 to 12 vertices.
inline Rings building(std::uint32_t seed) {
  static const std::array<std::vector<std::array<double, 2>>, 5> kPlans{{
      {{0, 0}, {3, 0}, {3, 2}, {0, 2}},
      {{0, 0}, {3, 0}, {3, 2}, {1, 2}, {1, 1}, {0, 1}},
      {{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
      {{1, 0},
       {2, 0},
       {2, 1},
       {3, 1},
       {3, 2},
       {2, 2},
       {2, 3},
       {1, 3},
       {1, 2},
       {0, 2},
       {0, 1},
       {1, 1}},
      {{0, 0},
       {5, 0},
       {5, 2},
       {4, 2},
       {4, 1},
       {3, 1},
       {3, 2},
       {2, 2},
       {2, 1},
       {1, 1},
       {1, 2},
       {0, 2}},
  }};
  UnitNumbers random(seed);
  const auto& plan = kPlans[seed % kPlans.size()];
  const double angle = 2 * std::numbers::pi * random.next();
  const double size = 200 + 800 * random.next();  // 4 to 20 m
  const double x = 1e6 * random.next();
  const double y = 1e6 * random.next();
  Rings rings;
  for (const auto& [u, v] : plan) {
    rings.points.push_back(cell_at(x + size * (u * std::cos(angle) - v * std::sin(angle)),
                                   y + size * (u * std::sin(angle) + v * std::cos(angle))));
  }
  rings.close_ring();
  return rings;
}

/// A coast: star-shaped around the centre, with bays of all sizes.
inline Rings wiggly_star(std::size_t vertices) {
  UnitNumbers random(1);
  const double step = 2 * std::numbers::pi / static_cast<double>(vertices);
  Rings rings;
  for (std::size_t i = 0; i < vertices; ++i) {
    const double angle = step * static_cast<double>(i);
    double radius = 0.7;
    for (double waves = 5; waves * 16 * step < 2 * std::numbers::pi; waves *= 3) {
      radius += 0.5 / waves * std::sin(waves * angle + waves);
    }
    radius += step * (random.next() - 0.5);
    radius *= kFamilyReach;
    rings.points.push_back(cell_at(radius * std::cos(angle), radius * std::sin(angle)));
  }
  rings.close_ring();
  return rings;
}

/// A roof with teeth hanging from it, two vertices each; length(i, teeth) in (0, 1].
template <class Length>
Rings comb_of(std::size_t vertices, const Length& length) {
  const std::size_t teeth = std::max<std::size_t>(1, vertices / 2 - 1);
  const double width = 2 * kFamilyReach / static_cast<double>(teeth);
  UnitNumbers random(2);
  Rings rings;
  rings.points.push_back(cell_at(kFamilyReach, -kFamilyReach));
  rings.points.push_back(cell_at(-kFamilyReach, -kFamilyReach));
  for (std::size_t i = 0; i < teeth; ++i) {
    const double x = -kFamilyReach + width * static_cast<double>(i);
    const double root = -kFamilyReach + 2e5 + 1e5 * random.next();
    rings.points.push_back(cell_at(x, root));
    rings.points.push_back(cell_at(x + width / 2, root + length(i, teeth) * 1.9 * kFamilyReach));
  }
  rings.close_ring();
  return rings;
}

/// Teeth nearly as long as the polygon: all edges cross the sweep line at the same time.
inline Rings long_edges(std::size_t vertices) {
  UnitNumbers random(3);
  return comb_of(vertices, [&](std::size_t, std::size_t) { return 0.999 + 0.001 * random.next(); });
}

inline Rings comb(std::size_t vertices) {
  UnitNumbers random(4);
  return comb_of(vertices, [&](std::size_t, std::size_t) { return 0.01 + 0.99 * random.next(); });
}

/// Each tooth is longer than the one before: the farthest vertex is always the last one.
inline Rings sorted_comb(std::size_t vertices) {
  return comb_of(vertices, [](std::size_t i, std::size_t teeth) {
    return static_cast<double>(i + 1) / static_cast<double>(teeth);
  });
}

/// A band with twenty vertices per turn on either side, with as many turns as there are vertices
/// for.
inline Rings spiral(std::size_t vertices) {
  constexpr double kPerTurn = 20;
  const std::size_t steps = vertices / 2;
  const double pitch = kFamilyReach / (static_cast<double>(steps) / kPerTurn + 2);
  const auto at = [&](std::size_t i, double outwards) {
    const double turns = static_cast<double>(i) / kPerTurn;
    const double radius = pitch * (turns + 1 + outwards);
    return cell_at(radius * std::cos(2 * std::numbers::pi * turns),
                   radius * std::sin(2 * std::numbers::pi * turns));
  };
  Rings rings;
  for (std::size_t i = 0; i < steps; ++i) rings.points.push_back(at(i, 0.5));
  for (std::size_t i = steps; i > 0; --i) rings.points.push_back(at(i - 1, 0));
  rings.close_ring();
  return rings;
}

/// A square with holes of five vertices in rows and columns.
inline Rings grid_of_holes(std::size_t vertices) {
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(vertices) / 5));
  const double field = 2 * kFamilyReach / static_cast<double>(side);
  UnitNumbers random(5);
  Rings rings;
  const double edge = kFamilyReach + 1000;
  rings.add(std::vector<Point>{cell_at(-edge, -edge), cell_at(edge, -edge), cell_at(edge, edge),
                               cell_at(-edge, edge)});
  for (std::size_t i = 0; i < side * side; ++i) {
    const double x = -kFamilyReach + field * (static_cast<double>(i % side) + 0.5);
    const double y = -kFamilyReach + field * (static_cast<double>(i / side) + 0.5);
    for (int k = 0; k < 5; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.8 * random.next()) / 5;
      const double radius = field * (0.2 + 0.25 * random.next());
      rings.points.push_back(cell_at(x + radius * std::cos(angle), y + radius * std::sin(angle)));
    }
    rings.close_ring();
  }
  return rings;
}

/// Long horizontal teeth: edges are nearly level, and few cross the sweep line at the same time.
inline Rings zigzag(std::size_t vertices) {
  Rings rings = long_edges(vertices);
  for (Point& p : rings.points) std::swap(p.x, p.y);
  return rings;
}

/// Stairs up and down again: every edge is level or upright, two steps are on each level.
inline Rings staircase(std::size_t vertices) {
  const std::size_t steps = vertices / 4;
  const double size = kFamilyReach / static_cast<double>(steps + 1);
  const auto at = [&](double x, double y) { return cell_at(size * x, size * y); };
  Rings rings;
  const auto count = static_cast<double>(steps);
  for (std::size_t i = 0; i < steps; ++i) {
    const auto k = static_cast<double>(i);
    rings.points.push_back(at(k - count, -k));
    rings.points.push_back(at(k - count, -k - 1));
  }
  for (std::size_t i = 0; i < steps; ++i) {
    const auto k = static_cast<double>(i);
    rings.points.push_back(at(k + 1, k - count));
    rings.points.push_back(at(k + 1, k + 1 - count));
  }
  rings.close_ring();
  return rings;
}

/// Teeth with right angles, all of the same length: all vertices are on three levels.
inline Rings battlement(std::size_t vertices) {
  const std::size_t teeth = std::max<std::size_t>(1, vertices / 4);
  const double width = 2 * kFamilyReach / static_cast<double>(teeth);
  Rings rings;
  rings.points.push_back(cell_at(-kFamilyReach, kFamilyReach));
  for (std::size_t i = 0; i < teeth; ++i) {
    const double x = -kFamilyReach + width * static_cast<double>(i);
    rings.points.push_back(cell_at(x, -kFamilyReach));
    rings.points.push_back(cell_at(x + width / 2, -kFamilyReach));
    rings.points.push_back(cell_at(x + width / 2, 0));
    rings.points.push_back(cell_at(x + width, 0));
  }
  rings.points.push_back(cell_at(kFamilyReach, kFamilyReach));
  rings.close_ring();
  return rings;
}

/// A sun: spikes around a circle, whose tips are all on the convex hull.
inline Rings spiky_star(std::size_t vertices) {
  const double step = 2 * std::numbers::pi / static_cast<double>(vertices);
  Rings rings;
  for (std::size_t i = 0; i < vertices; ++i) {
    const double angle = step * static_cast<double>(i);
    const double radius = (i % 2 == 0 ? 1 : 0.5) * kFamilyReach;
    rings.points.push_back(cell_at(radius * std::cos(angle), radius * std::sin(angle)));
  }
  rings.close_ring();
  return rings;
}

/// A family that grows: make(n) has about n vertices, n >= 20.
struct PolygonFamily {
  std::string_view name;
  Rings (*make)(std::size_t vertices);
};

constexpr std::array<PolygonFamily, 10> kPolygonFamilies{{
    {"wiggly_star", wiggly_star},
    {"long_edges", long_edges},
    {"comb", comb},
    {"sorted_comb", sorted_comb},
    {"spiral", spiral},
    {"grid_of_holes", grid_of_holes},
    {"zigzag", zigzag},
    {"staircase", staircase},
    {"battlement", battlement},
    {"spiky_star", spiky_star},
}};

}  // namespace trapeze
