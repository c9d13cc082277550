// Random polygons of many kinds for property tests; each shape is determined by its seed.
#pragma once

#include <cmath>
#include <random>
#include <string>

#include "core/grid/rings.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {

/// Stars with holes and islands, combs, spirals, nested squares with touching corners, scribbles,
/// chosen by the seed.
inline Rings random_shape(unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&](int a, int b) {
    return std::uniform_int_distribution<int>(a, b)(random);
  };
  Rings rings;
  switch (seed % 7) {
    case 0: {  // a star with a hole and an island
      const double scale = seed % 2 == 0 ? 40 : 100000;
      rings.add(random_star(random, {0, 0}, between(5, 60), 0.5 * scale, scale));
      rings.add(random_star(random, {0, 0}, between(5, 40), 0.2 * scale, 0.4 * scale));
      rings.add(random_star(random, {0, 0}, between(4, 20), 0.05 * scale, 0.15 * scale));
      break;
    }
    case 1: {  // a comb
      const int teeth = between(2, 25);
      for (int i = 0; i < teeth; ++i) {
        rings.points.push_back({i * 20, between(-3, 3)});
        rings.points.push_back({i * 20 + between(5, 15), between(100, 300)});
      }
      rings.points.push_back({teeth * 20, -50});
      rings.points.push_back({-20, -50});
      rings.close_ring();
      break;
    }
    case 2: {  // a spiral
      const int turns = between(20, 120);
      std::vector<Point> inner;
      for (int i = 0; i < turns; ++i) {
        const double angle = 0.35 * i;
        const double r = 50 + 10.0 * i;
        const auto at = [&](double radius) {
          return Point{static_cast<std::int32_t>(radius * std::cos(angle)),
                       static_cast<std::int32_t>(radius * std::sin(angle))};
        };
        rings.points.push_back(at(r + between(70, 90)));
        inner.push_back(at(r));
      }
      rings.points.insert(rings.points.end(), inner.rbegin(), inner.rend());
      rings.close_ring();
      break;
    }
    case 3: {  // a scribble: crossings, touches and overlaps everywhere
      const int range = seed % 2 == 0 ? 15 : 100000;
      for (int r = 0; r < 2; ++r) {
        for (int i = between(6, 25); i > 0; --i)
          rings.points.push_back({between(-range, range), between(-range, range)});
        rings.close_ring();
      }
      break;
    }
    case 4: {  // many holes in a grid
      rings.add(random_star(random, {500, 500}, 40, 900, 1000));
      for (int x = 0; x < 8; ++x) {
        for (int y = 0; y < 8; ++y) {
          rings.add(random_star(random, {200 + x * 80, 200 + y * 80}, between(3, 8), 15, 38));
        }
      }
      break;
    }
    case 5: {  // squares on a lattice: horizontal edges, touching corners, shared edges
      for (int i = between(2, 14); i > 0; --i) {
        const int x = between(0, 8) * 5;
        const int y = between(0, 8) * 5;
        const int w = between(1, 4) * 5;
        const int h = between(1, 4) * 5;
        rings.add(std::vector<Point>{{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}});
      }
      break;
    }
    default: {  // a wiggly coast with lakes close to it
      const auto coast = random_star(random, {0, 0}, 200, 9000, 10000);
      rings.add(coast);
      for (int i = 0; i < 12; ++i) {
        const double angle = 0.5 * i;
        rings.add(random_star(random,
                              {static_cast<std::int32_t>(7800 * std::cos(angle)),
                               static_cast<std::int32_t>(7800 * std::sin(angle))},
                              between(3, 20), 300, 1100));
      }
      break;
    }
  }
  return rings;
}

}  // namespace trapeze
