// Maps of many features; some share borders and others overlap each other.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "core/grid/rings.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {

using Map = std::vector<Rings>;  // by feature

inline Rings moved_by(Rings rings, Point by) {
  for (Point& p : rings.points) p = {p.x + by.x, p.y + by.y};
  return rings;
}

/// Square parcels, `side` of them on a side, with random corners; neighbours share borders.
inline void add_block(std::mt19937& random, Point at, int side, Map& map) {
  constexpr int kSize = 400;
  std::uniform_int_distribution<int> jitter(-kSize / 4, kSize / 4);
  std::vector<Point> corners;
  for (int y = 0; y <= side; ++y) {
    for (int x = 0; x <= side; ++x) {
      corners.push_back({at.x + x * kSize + jitter(random), at.y + y * kSize + jitter(random)});
    }
  }
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const auto corner = [&](int dx, int dy) {
        return corners[static_cast<std::size_t>((y + dy) * (side + 1) + x + dx)];
      };
      Rings rings;
      rings.add(std::vector<Point>{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)});
      map.push_back(rings);
    }
  }
}

/// Overlapping shapes of all kinds, some of them repeated, and blocks of parcels.
inline Map sample_map(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> place(-20000, 20000);
  Map map;
  for (unsigned i = 0; i < 16; ++i) {
    map.push_back(moved_by(random_shape(seed + i), {place(random), place(random)}));
  }
  map.push_back(map[3]);
  map.push_back(map[5]);
  map.push_back(map[3]);
  for (int block = 0; block < 5; ++block) {
    add_block(random, {place(random), place(random)}, 2 + block % 2, map);
  }
  map.push_back(map.back());
  return map;
}

}  // namespace trapeze
