#include "tests/hostile/hostile_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>

namespace trapeze {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

LonLat polar(double radius, double radians) {
  return {radius * std::cos(radians), radius * std::sin(radians)};
}

/// A ribbon of that width around a line of axis-parallel steps.
LonLatRing ribbon(const LonLatRing& line, double width) {
  LonLatRing left;
  LonLatRing right;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const LonLat from = line[i == 0 ? 0 : i - 1];
    const LonLat to = line[i + 1 < line.size() ? i + 1 : i];
    const double length = std::hypot(to.lon - from.lon, to.lat - from.lat);
    const double x = -(to.lat - from.lat) / length * width / 2;
    const double y = (to.lon - from.lon) / length * width / 2;
    left.push_back({line[i].lon + x, line[i].lat + y});
    right.push_back({line[i].lon - x, line[i].lat - y});
  }
  left.insert(left.end(), right.rbegin(), right.rend());
  return left;
}

/// The cell of Hilbert's curve over 4^order cells.
std::pair<int, int> hilbert_cell(int order, int index) {
  int x = 0;
  int y = 0;
  for (int side = 1; side < 1 << order; side *= 2, index /= 4) {
    const int in_x = 1 & (index / 2);
    const int in_y = 1 & (index ^ in_x);
    if (in_y == 0) {
      if (in_x == 1) {
        x = side - 1 - x;
        y = side - 1 - y;
      }
      std::swap(x, y);
    }
    x += side * in_x;
    y += side * in_y;
  }
  return {x, y};
}

void add_sierpinski_holes(int depth, LonLat corner, double side, std::vector<LonLatRing>& holes) {
  if (depth == 0) return;
  const double half = side / 2;
  const auto [x, y] = corner;
  holes.push_back({{x + half, y}, {x + half, y + half}, {x, y + half}});
  add_sierpinski_holes(depth - 1, corner, half, holes);
  add_sierpinski_holes(depth - 1, {x + half, y}, half, holes);
  add_sierpinski_holes(depth - 1, {x, y + half}, half, holes);
}

}  // namespace

LonLatRing square(double west, double south, double side) {
  return rectangle(west, south, west + side, south + side);
}

LonLatRing rectangle(double west, double south, double east, double north) {
  return {{west, south}, {east, south}, {east, north}, {west, north}};
}

LonLatRing star(int points, double inner, double outer, LonLat centre) {
  LonLatRing ring;
  for (int i = 0; i < points; ++i) {
    const LonLat p = polar(i % 2 == 0 ? outer : inner, kTurn * i / points);
    ring.push_back({centre.lon + p.lon, centre.lat + p.lat});
  }
  return ring;
}

LonLatRing star_polygon(int points, int step, double radius) {
  LonLatRing ring;
  std::int64_t corner = 0;
  for (int i = 0; i < points; ++i, corner = (corner + step) % points) {
    ring.push_back(polar(radius, kTurn * static_cast<double>(corner) / points));
  }
  return ring;
}

LonLatRing comb(int teeth, double pitch, double height, double lean) {
  LonLatRing ring;
  for (int i = 0; i < teeth; ++i) {
    ring.push_back({i * pitch, 0});
    ring.push_back({(i + 0.5) * pitch + lean, height});
  }
  ring.push_back({teeth * pitch, 0});
  ring.push_back({teeth * pitch, -height / 10});
  ring.push_back({0, -height / 10});
  return ring;
}

LonLatRing with_bow_tie_in_the_middle(LonLatRing ring) {
  const std::size_t middle = ring.size() / 2;
  std::swap(ring[middle], ring[middle + 1]);
  return ring;
}

LonLatRing battlements(int merlons, double pitch, double height) {
  LonLatRing ring;
  for (int i = 0; i < merlons; ++i) {
    ring.push_back({i * pitch, 0});
    ring.push_back({i * pitch, height});
    ring.push_back({(i + 0.5) * pitch, height});
    ring.push_back({(i + 0.5) * pitch, 0});
  }
  ring.push_back({(merlons - 0.5) * pitch, -height});
  ring.push_back({0, -height});
  return ring;
}

LonLatRing staircase(int steps, double step) {
  LonLatRing ring;
  for (int i = 0; i < steps; ++i) {
    ring.push_back({i * step, i * step});
    ring.push_back({(i + 1) * step, i * step});
  }
  ring.push_back({steps * step, steps * step});
  ring.push_back({0, steps * step});
  return ring;
}

LonLatRing spiral(int turns, int corners_a_turn, double width) {
  LonLatRing outer;
  LonLatRing inner;
  const double pitch = 5.0 / turns;
  for (int i = 0; i <= turns * corners_a_turn; ++i) {
    const double turned = static_cast<double>(i) / corners_a_turn;
    outer.push_back(polar(pitch * (turned + 1 + width), kTurn * turned));
    inner.push_back(polar(pitch * (turned + 1), kTurn * turned));
  }
  outer.insert(outer.end(), inner.rbegin(), inner.rend());
  return outer;
}

LonLatRing koch_snowflake(int depth, double radius) {
  LonLatRing ring = star(3, radius, radius);
  for (; depth > 0; --depth) {
    LonLatRing finer;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const LonLat a = ring[i];
      const LonLat b = ring[(i + 1) % ring.size()];
      const double x = (b.lon - a.lon) / 3;
      const double y = (b.lat - a.lat) / 3;
      const double h = std::sqrt(3) / 2;
      finer.push_back(a);
      finer.push_back({a.lon + x, a.lat + y});
      finer.push_back({a.lon + 1.5 * x + h * y, a.lat + 1.5 * y - h * x});
      finer.push_back({a.lon + 2 * x, a.lat + 2 * y});
    }
    ring.swap(finer);
  }
  return ring;
}

LonLatRing hilbert_ribbon(int order, double side, double width) {
  LonLatRing line;
  const double step = side / (1 << order);
  for (int i = 0; i < 1 << (2 * order); ++i) {
    const auto [x, y] = hilbert_cell(order, i);
    line.push_back({x * step, y * step});
  }
  return ribbon(line, width * step);
}

LonLatRing dragon_curve(int folds, double step) {
  LonLatRing ring{{0, 0}};
  int direction = 0;
  for (unsigned i = 1; i < 1u << folds; ++i) {
    const double x = direction % 2 == 0 ? 1 - direction : 0;
    const double y = direction % 2 == 1 ? 2 - direction : 0;
    ring.push_back({ring.back().lon + step * x, ring.back().lat + step * y});
    const bool turns_left = ((i & -i) << 1 & i) != 0;
    direction = (direction + (turns_left ? 1 : 3)) % 4;
  }
  return ring;
}

LonLatRing lissajous(int points, int a, int b) {
  LonLatRing ring;
  for (int i = 0; i < points; ++i) {
    const double t = kTurn * i / points;
    ring.push_back({5 * std::sin(a * t + 0.3), 5 * std::sin(b * t)});
  }
  return ring;
}

LonLatRing flower(int petals, double radius) {
  LonLatRing ring;
  for (int i = 0; i < petals; ++i) {
    ring.push_back({0, 0});
    ring.push_back(polar(radius, kTurn * i / petals));
    ring.push_back(polar(radius, kTurn * (i + 0.5) / petals));
  }
  return ring;
}

LonLatRing chain_of_bow_ties(int ties) {
  LonLatRing ring;
  LonLatRing back;
  const double pitch = 10.0 / ties;
  for (int i = 0; i <= ties; ++i) {
    const double side = i % 2 == 0 ? 0.1 : -0.1;
    ring.push_back({i * pitch, side});
    back.push_back({i * pitch, -side});
  }
  ring.insert(ring.end(), back.rbegin(), back.rend());
  return ring;
}

LonLatRing sliver(double length, double thickness, double radians) {
  const LonLat far = polar(length, radians);
  const LonLat side = polar(thickness, radians + kTurn / 4);
  return {{0, 0}, far, {far.lon + side.lon, far.lat + side.lat}};
}

LonLatRing soup(int points, double side, unsigned seed) {
  std::mt19937 random(seed);
  LonLatRing ring;
  const auto draw = [&] { return side * (static_cast<double>(random()) / 4294967296.0 - 0.5); };
  for (int i = 0; i < points; ++i) {
    const double lon = draw();
    ring.push_back({lon, draw()});
  }
  return ring;
}

LonLatRing lattice_soup(int points, int cells, double step, unsigned seed) {
  std::mt19937 random(seed);
  LonLatRing ring;
  const auto draw = [&] {
    return step * static_cast<int>(random() % static_cast<unsigned>(cells + 1));
  };
  for (int i = 0; i < points; ++i) {
    const double lon = draw();
    ring.push_back({lon, draw()});
  }
  return ring;
}

LonLatRing random_walk(int points, double step, unsigned seed) {
  std::mt19937 random(seed);
  LonLatRing ring{{0, 0}};
  while (static_cast<int>(ring.size()) < points) {
    LonLat next = ring.back();
    const unsigned direction = random() % 4;
    (direction % 2 == 0 ? next.lon : next.lat) += direction < 2 ? step : -step;
    ring.push_back(next);
  }
  return ring;
}

LonLatRing there_and_back(int points) {
  LonLatRing ring;
  for (int i = 0; i < points; ++i) ring.push_back({i * 1e-3, i * 1e-3});
  for (int i = points - 2; i > 0; --i) ring.push_back({i * 1e-3, i * 1e-3});
  return ring;
}

LonLatRing repeated(const LonLatRing& ring, int times_each) {
  LonLatRing result;
  for (const LonLat p : ring) {
    result.insert(result.end(), static_cast<std::size_t>(times_each), p);
  }
  return result;
}

LonLatRing reversed(LonLatRing ring) {
  std::reverse(ring.begin(), ring.end());
  return ring;
}

LonLatRing moved(LonLatRing ring, double east, double north) {
  for (LonLat& p : ring) p = {p.lon + east, p.lat + north};
  return ring;
}

std::vector<LonLatRing> nested_squares(int depth, double gap) {
  std::vector<LonLatRing> rings;
  for (int i = 0; i < depth; ++i) rings.push_back(square(i * gap, i * gap, 2 * (depth - i) * gap));
  return rings;
}

std::vector<LonLatRing> checkerboard(int squares, double side) {
  std::vector<LonLatRing> rings;
  for (int y = 0; y < squares; ++y) {
    for (int x = y % 2; x < squares; x += 2) rings.push_back(square(x * side, y * side, side));
  }
  return rings;
}

std::vector<LonLatRing> lattice_of_squares(int squares, double pitch, double side) {
  std::vector<LonLatRing> rings;
  for (int y = 0; y < squares; ++y) {
    for (int x = 0; x < squares; ++x) rings.push_back(square(x * pitch, y * pitch, side));
  }
  return rings;
}

std::vector<LonLatRing> random_triangles(int count, double size, unsigned seed) {
  const LonLatRing places = soup(count, 10, seed);
  const LonLatRing corners = soup(3 * count, size, seed + 1);
  std::vector<LonLatRing> triangles;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const LonLatRing triangle(corners.begin() + static_cast<std::ptrdiff_t>(3 * i),
                              corners.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
    triangles.push_back(moved(triangle, places[i].lon, places[i].lat));
  }
  return triangles;
}

std::vector<LonLatRing> sierpinski_holes(int depth, double side) {
  std::vector<LonLatRing> holes;
  add_sierpinski_holes(depth, {0, 0}, side, holes);
  return holes;
}

}  // namespace trapeze
