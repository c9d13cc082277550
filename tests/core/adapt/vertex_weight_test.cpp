#include "core/adapt/vertex_weight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr WeightRule kAllRules[] = {WeightRule::douglas_peucker, WeightRule::raised_parents,
                                    WeightRule::effective_area, WeightRule::shape};

using Ring = std::vector<Point>;

std::vector<double> weigh(const Ring& ring, WeightRule rule) {
  VertexWeights weights;
  const auto w = weights.weigh(ring, rule);
  return {w.begin(), w.end()};
}

bool has_repeated_points(std::span<const Point> ring) {
  std::set<std::pair<std::int32_t, std::int32_t>> points;
  for (const Point p : ring) points.insert({p.x, p.y});
  return points.size() < ring.size();
}

/// Rings of all kinds, without repeated points.
std::vector<Ring> rings_to_weigh() {
  std::vector<Ring> found;
  for (unsigned seed = 0; seed < 140; ++seed) {
    const Rings rings = random_shape(seed);
    for (std::size_t i = 0; i < rings.size() && i < 4; ++i) {
      if (rings[i].size() < 3 || has_repeated_points(rings[i])) continue;
      found.emplace_back(rings[i].begin(), rings[i].end());
    }
  }
  return found;
}

/// A straightforward binary recursive partitioning: for every vertex, its distance from the chord
/// that it splits, and the vertex that split the previous piece.
class Partitioning {
 public:
  explicit Partitioning(const Ring& ring)
      : distance(ring.size(), kInfinite), parent(ring.size(), ring.size()), ring_(ring) {
    const auto first = std::min_element(ring.begin(), ring.end(), is_above);
    const auto squared = [&](Point p) {
      return std::pow(double{0} + p.x - first->x, 2) + std::pow(double{0} + p.y - first->y, 2);
    };
    auto second = ring.begin();
    for (auto p = ring.begin(); p != ring.end(); ++p) {
      if (squared(*p) > squared(*second) ||
          (squared(*p) == squared(*second) && is_above(*p, *second)))
        second = p;
    }
    const auto a = static_cast<std::size_t>(first - ring.begin());
    const auto b = static_cast<std::size_t>(second - ring.begin());
    split(a, b, ring.size());
    split(b, a, ring.size());
  }

  std::vector<double> distance;
  std::vector<std::size_t> parent;  // ring.size() for vertices without one
  std::vector<std::size_t> order;   // parents before children

 private:
  void split(std::size_t a, std::size_t b, std::size_t above) {
    const std::size_t n = ring_.size();
    const std::size_t length = (b + n - a - 1) % n;  // vertices between
    if (length == 0) return;
    const auto between = [&](std::size_t k) { return (a + 1 + k) % n; };
    const auto far = [&](std::size_t k) {
      return squared_distance(ring_[between(k)], ring_[a], ring_[b]);
    };
    const auto off_middle = [&](std::size_t k) { return std::max(k + 1, length - k); };
    std::size_t best = 0;
    for (std::size_t k = 1; k < length; ++k) {
      if (far(k) > far(best) ||
          (far(k) == far(best) && (off_middle(k) < off_middle(best) ||
                                   (off_middle(k) == off_middle(best) &&
                                    is_above(ring_[between(k)], ring_[between(best)]))))) {
        best = k;
      }
    }
    const std::size_t v = between(best);
    distance[v] = std::sqrt(far(best));
    parent[v] = above;
    order.push_back(v);
    split(a, v, v);
    split(v, b, v);
  }

  const Ring& ring_;
};

// The paper's Figure 2: V3 is farthest from V1-V5, V2 from V1-V3, V4 from V3-V5.
//
//   V1------------------------------V5
//     \            | H1           .'
//      \ H2        |          H3 /
//       V2         |           V4
//          '-.     |       .-'
//              '---V3---'
const Ring kFigure2{{0, 0}, {20, 40}, {50, 60}, {80, 45}, {100, 10}};

TEST(Figure2, EveryVertexIsWeighedByTheChordThatItSplits) {
  const auto w = weigh(kFigure2, WeightRule::douglas_peucker);
  const double h1 = std::abs(100.0 * 60 - 10.0 * 50) / std::hypot(100, 10);
  const double h2 = std::abs(50.0 * 40 - 60.0 * 20) / std::hypot(50, 60);
  const double h3 = std::abs(50.0 * -15 - -50.0 * 30) / std::hypot(50, -50);
  EXPECT_EQ(w[0], kInfinite);
  EXPECT_EQ(w[4], kInfinite);
  EXPECT_NEAR(w[2], h1, 1e-9);
  EXPECT_NEAR(w[1], h2, 1e-9);
  EXPECT_NEAR(w[3], h3, 1e-9);
}

TEST(Figure2, NoChildOutweighsItsParentSoBothDistanceRulesAgree) {
  EXPECT_EQ(weigh(kFigure2, WeightRule::douglas_peucker),
            weigh(kFigure2, WeightRule::raised_parents));
}

// Where a child is farther from its chord than its parent is from its own, one rule lowers the
// child; the other, Eq. (1), raises the parent.
TEST(VertexWeights, AChildFartherThanItsParentIsLoweredOrTheParentRaised) {
  // The second vertex splits the first and the last at a distance of 30; the third is 45 from the
  // remaining chord.
  const Ring ring{{0, 0}, {50, 30}, {5, 25}, {100, 0}};
  const Partitioning tree(ring);
  bool found = false;
  const auto lowered = weigh(ring, WeightRule::douglas_peucker);
  const auto raised = weigh(ring, WeightRule::raised_parents);
  for (const std::size_t v : tree.order) {
    const std::size_t p = tree.parent[v];
    if (p == ring.size() || tree.distance[v] <= tree.distance[p]) continue;
    found = true;
    EXPECT_EQ(lowered[v], tree.distance[p]);
    EXPECT_EQ(lowered[p], tree.distance[p]);
    EXPECT_EQ(raised[v], tree.distance[v]);
    EXPECT_EQ(raised[p], tree.distance[v]);
  }
  EXPECT_TRUE(found) << "the example shows nothing";
}

TEST(VertexWeights, LoweredChildrenAreTheSmallestDistanceUpTheTree) {
  for (const Ring& ring : rings_to_weigh()) {
    const Partitioning tree(ring);
    std::vector<double> wanted = tree.distance;
    for (const std::size_t v : tree.order) {
      if (tree.parent[v] < ring.size()) wanted[v] = std::min(wanted[v], wanted[tree.parent[v]]);
    }
    ASSERT_EQ(weigh(ring, WeightRule::douglas_peucker), wanted);
  }
}

TEST(VertexWeights, RaisedParentsAreNeverLessThanTheirChildren) {
  for (const Ring& ring : rings_to_weigh()) {
    const Partitioning tree(ring);
    const auto w = weigh(ring, WeightRule::raised_parents);
    for (const std::size_t v : tree.order) {
      if (tree.parent[v] < ring.size()) {
        ASSERT_GE(w[tree.parent[v]], w[v]);
      }
    }
  }
}

TEST(VertexWeights, RaisedParentsAreTheGreatestDistanceBelowThem) {
  for (const Ring& ring : rings_to_weigh()) {
    const Partitioning tree(ring);
    std::vector<double> wanted = tree.distance;
    for (std::size_t i = tree.order.size(); i > 0; --i) {
      const std::size_t v = tree.order[i - 1];
      const std::size_t p = tree.parent[v];
      if (p < ring.size()) wanted[p] = std::max(wanted[p], wanted[v]);
    }
    ASSERT_EQ(weigh(ring, WeightRule::raised_parents), wanted);
  }
}

/// Visvalingam and Whyatt, recomputing all triangles after every step.
std::vector<double> areas_the_plain_way(const Ring& ring) {
  std::vector<double> w(ring.size(), kInfinite);
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < ring.size(); ++i) left.push_back(i);
  double largest = 0;
  while (left.size() > 2) {
    const auto area = [&](std::size_t k) {
      const Point a = ring[left[(k + left.size() - 1) % left.size()]];
      const Point b = ring[left[k]];
      const Point c = ring[left[(k + 1) % left.size()]];
      return std::abs(static_cast<double>(orientation(a, b, c))) / 2;
    };
    std::size_t best = 0;
    for (std::size_t k = 1; k < left.size(); ++k) {
      if (area(k) < area(best) ||
          (area(k) == area(best) && is_above(ring[left[k]], ring[left[best]])))
        best = k;
    }
    largest = std::max(largest, area(best));
    w[left[best]] = std::sqrt(largest);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return w;
}

TEST(VertexWeights, EffectiveAreaIsThatOfRemovingTheSmallestTriangleEachTime) {
  for (const Ring& ring : rings_to_weigh())
    ASSERT_EQ(weigh(ring, WeightRule::effective_area), areas_the_plain_way(ring));
}

TEST(VertexWeights, AreTheSameWhereverTheRingStartsAndWhicheverWayItRuns) {
  std::mt19937 random(7);
  for (const Ring& ring : rings_to_weigh()) {
    const std::size_t start = random() % ring.size();
    Ring turned = ring;
    std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(start), turned.end());
    Ring reversed(ring.rbegin(), ring.rend());
    for (const WeightRule rule : kAllRules) {
      SCOPED_TRACE(std::string(kWeightNames.name_of(rule)));
      const auto plain = weigh(ring, rule);
      const auto of_turned = weigh(turned, rule);
      const auto of_reversed = weigh(reversed, rule);
      for (std::size_t i = 0; i < ring.size(); ++i) {
        ASSERT_EQ(plain[(i + start) % ring.size()], of_turned[i]);
        ASSERT_EQ(plain[i], of_reversed[ring.size() - 1 - i]);
      }
    }
  }
}

TEST(VertexWeights, TwoCornersOfEveryRingAreNeverWeighed) {
  for (const Ring& ring : rings_to_weigh()) {
    for (const WeightRule rule : kAllRules) {
      const auto w = weigh(ring, rule);
      EXPECT_EQ(std::count(w.begin(), w.end(), kInfinite), 2);
    }
  }
}

TEST(VertexWeights, RulesAreFoundByTheirNames) {
  for (const WeightRule rule : kAllRules)
    EXPECT_EQ(kWeightNames.find(kWeightNames.name_of(rule)), rule);
  EXPECT_EQ(kWeightNames.find("douglas"), std::nullopt);
  EXPECT_EQ(kWeightNames.find(""), std::nullopt);
}

}  // namespace
}  // namespace trapeze
