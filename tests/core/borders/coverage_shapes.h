// Random coverages for property tests: polygons that share borders. Each is determined by its seed.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "core/grid/rings.h"
#include "core/sweep/clean_rings.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {

/// A grid of cells with shifted corners and wiggly borders that both neighbours follow. The cells
/// are assigned to fewer features than there are cells, and some cells to none. Some cells have
/// enclaves inside, and some of these enclaves lie in a ring of another feature.
class WiggledGrid {
 public:
  explicit WiggledGrid(unsigned seed) : random_(seed) {
    columns_ = between(1, 5);
    rows_ = between(1, 5);
    width_ = seed % 3 == 0 ? 12 : seed % 3 == 1 ? 300 : 40000;
    wiggle_ = width_ / 7;
    const int features = between(2, columns_ * rows_ + 1);
    features_.resize(static_cast<std::size_t>(features));
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) add_cell(x, y, between(-1, features - 1));
    }
    for (Rings& rings : features_) clean_rings(rings);
  }

  const std::vector<Rings>& features() const { return features_; }

 private:
  int between(int a, int b) { return std::uniform_int_distribution<int>(a, b)(random_); }

  Point corner(int x, int y) {
    const auto [found, is_new] = corners_.try_emplace({x, y});
    if (is_new) {
      found->second = {x * width_ + between(-wiggle_, wiggle_),
                       y * width_ + between(-wiggle_, wiggle_)};
    }
    return found->second;
  }

  /// The points between two corners, always from the first to the second.
  const std::vector<Point>& border(std::pair<int, int> from, std::pair<int, int> to) {
    const auto [found, is_new] = borders_.try_emplace({from, to});
    if (!is_new) return found->second;
    const Point a = corner(from.first, from.second);
    const Point b = corner(to.first, to.second);
    const int count = between(0, 12);
    for (int i = 1; i <= count; ++i) {
      const double share = static_cast<double>(i) / (count + 1);
      found->second.push_back(
          {static_cast<std::int32_t>(a.x + share * (b.x - a.x)) + between(-wiggle_, wiggle_) / 2,
           static_cast<std::int32_t>(a.y + share * (b.y - a.y)) + between(-wiggle_, wiggle_) / 2});
    }
    return found->second;
  }

  void add_cell(int x, int y, int feature) {
    std::vector<Point> ring;
    const auto side = [&](std::pair<int, int> from, std::pair<int, int> to, bool forward) {
      std::vector<Point> points = border(from, to);
      points.insert(points.begin(), corner(from.first, from.second));
      points.push_back(corner(to.first, to.second));
      if (!forward) std::reverse(points.begin(), points.end());
      ring.insert(ring.end(), points.begin(), points.end() - 1);
    };
    side({x, y}, {x + 1, y}, true);
    side({x + 1, y}, {x + 1, y + 1}, true);
    side({x, y + 1}, {x + 1, y + 1}, false);
    side({x, y}, {x, y + 1}, false);
    if (feature >= 0) features_[static_cast<std::size_t>(feature)].add(ring);
    if (between(0, 2) == 0) add_enclave(x, y, feature);
  }

  /// Takes a star out of the middle of the cell and gives it to another feature; or gives a ring of
  /// it to one feature and the middle to the next.
  void add_enclave(int x, int y, int around) {
    const Point middle{x * width_ + width_ / 2, y * width_ + width_ / 2};
    const int count = static_cast<int>(features_.size());
    double radius = 0.2 * width_;
    for (int depth = between(1, 2); depth > 0; --depth, radius *= 0.5) {
      const int inside = between(-1, count - 1);
      if (inside == around) return;
      const auto star = random_star(random_, middle, between(4, 14), 0.6 * radius, radius);
      if (around >= 0) features_[static_cast<std::size_t>(around)].add(star);
      if (inside >= 0) features_[static_cast<std::size_t>(inside)].add(star);
      around = inside;
    }
  }

  std::mt19937 random_;
  int columns_ = 1;
  int rows_ = 1;
  int width_ = 1;
  int wiggle_ = 1;
  std::map<std::pair<int, int>, Point> corners_;
  std::map<std::pair<std::pair<int, int>, std::pair<int, int>>, std::vector<Point>> borders_;
  std::vector<Rings> features_;
};

/// Coverages of all kinds: wiggled grids, and stars and squares that overlap, touch and leave gaps.
inline std::vector<Rings> random_coverage(unsigned seed) {
  if (seed % 4 != 0) return WiggledGrid(seed).features();
  std::mt19937 random(seed);
  const auto between = [&](int a, int b) {
    return std::uniform_int_distribution<int>(a, b)(random);
  };
  std::vector<Rings> features(static_cast<std::size_t>(between(2, 9)));
  for (Rings& rings : features) {
    for (int i = between(1, 3); i > 0; --i) {
      if (seed % 8 == 0) {
        const int x = between(0, 6) * 5;
        const int y = between(0, 6) * 5;
        const int w = between(1, 4) * 5;
        const int h = between(1, 4) * 5;
        rings.add(std::vector<Point>{{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}});
      } else {
        const Point middle{between(-200, 200), between(-200, 200)};
        rings.add(random_star(random, middle, between(3, 20), 40, 150));
      }
    }
    clean_rings(rings);
  }
  return features;
}

/// The features of a coverage, for a builder.
inline std::vector<const Rings*> pointers_to(const std::vector<Rings>& features) {
  std::vector<const Rings*> pointers;
  for (const Rings& rings : features) pointers.push_back(&rings);
  return pointers;
}

}  // namespace trapeze
