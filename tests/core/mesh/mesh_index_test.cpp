#include "core/mesh/mesh_index.h"

#include <gtest/gtest.h>

#include <random>

namespace trapeze {
namespace {

/// A mesh of parallelograms and boxes, specified one by one.
struct Mesh {
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<MeshTrapezoid> trapezoids;

  void add(const Box& box) { append_box(box, vertices, edges, trapezoids); }

  /// The west side runs from x `from` at the top to x `to` at the bottom; the east side is far
  /// away.
  void add_leaning(std::int32_t from, std::int32_t to, std::int32_t top, std::int32_t bottom) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    const auto edge = static_cast<std::uint32_t>(edges.size());
    for (const Point& point :
         {Point{from, top}, Point{to, bottom}, Point{9000, top}, Point{9000, bottom}}) {
      vertices.push_back(point);
    }
    edges.push_back({first, first + 1});
    edges.push_back({first + 2, first + 3});
    trapezoids.push_back({first, first + 1, edge, edge + 1});
  }

  MeshView view() const { return {1, vertices, edges, trapezoids}; }
  bool covers(const Box& box) const {
    const TrapezoidRange all{0, static_cast<std::uint32_t>(trapezoids.size())};
    return cover_box(view(), {&all, 1}, box);
  }
};

constexpr Box kTile{1000, 1000, 1256, 1256};

TEST(CoverBoxTest, NothingCoversNothing) {
  EXPECT_FALSE(Mesh().covers(kTile));
}

TEST(CoverBoxTest, OneLargeTrapezoidCovers) {
  Mesh mesh;
  mesh.add({0, 0, 5000, 5000});
  EXPECT_TRUE(mesh.covers(kTile));
}

TEST(CoverBoxTest, StackedTrapezoidsCoverIfNoRowIsMissing) {
  Mesh mesh;
  mesh.add({0, 1100, 5000, 2000});
  mesh.add({0, 0, 5000, 1050});
  EXPECT_FALSE(mesh.covers(kTile));
  mesh.add({500, 1050, 3000, 1100});
  EXPECT_TRUE(mesh.covers(kTile));
}

TEST(CoverBoxTest, ASideInTheBoxIsNotCovered) {
  Mesh mesh;
  mesh.add({1001, 0, 5000, 5000});
  EXPECT_FALSE(mesh.covers(kTile));
  Mesh leaning;
  leaning.add_leaning(0, 1900, 0, 2000);  // crosses the middle of the box at its bottom
  EXPECT_FALSE(leaning.covers(kTile));
  Mesh leaning_beyond;
  leaning_beyond.add_leaning(0, 1500, 0, 2000);  // enters the box only below it
  EXPECT_TRUE(leaning_beyond.covers(kTile));
}

TEST(CoverBoxTest, AStripThatEndsWithinIsNotCovered) {
  Mesh mesh;
  mesh.add({0, 0, 5000, 1255});
  EXPECT_FALSE(mesh.covers(kTile));
}

/// Compares the index with a test of every trapezoid.
TEST(MeshIndexTest, SelectsWhatMeetsTheBoxAndIsAlive) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const auto below = [&random](int limit) { return static_cast<int>(random() % limit); };
  Mesh mesh;
  std::vector<Lifespan> lifespans;
  for (int i = 0; i < 1000; ++i) {
    const int x = below(10'000);
    const int y = below(10'000);
    mesh.add({x, y, x + 1 + below(300), y + 1 + below(300)});
    const auto born = static_cast<Level>(below(20));
    lifespans.push_back({born, static_cast<Level>(born + 1 + below(20))});
  }
  const MeshIndex index(mesh.view(), {0, 1000}, lifespans);
  for (int round = 0; round < 100; ++round) {
    const int x = below(10'000);
    const int y = below(10'000);
    const Box box{x, y, x + below(3000), y + below(3000)};
    const auto level = static_cast<Level>(below(40));
    std::vector<TrapezoidRange> ranges;
    index.select(box, level, level, lifespans, ranges);
    std::uint64_t selected = 0;
    for (const TrapezoidRange& range : ranges) selected += range.count;
    const std::uint64_t estimate = index.estimate(box, level, level);
    EXPECT_GE(8 * estimate, 5 * selected) << "eight of a block are found at most";
    EXPECT_LE(estimate, 5 * 125u) << "there are no more blocks";
    std::vector<bool> is_selected(1000, false);
    for (const TrapezoidRange& range : ranges) {
      for (std::uint32_t i = range.first; i < range.first + range.count; ++i) is_selected[i] = true;
    }
    for (std::size_t i = 0; i < 1000; ++i) {
      const bool is_alive = lifespans[i].born <= level && level < lifespans[i].dies;
      const bool meets = box_of(mesh.view(), mesh.trapezoids[i]).intersects(box);
      if (is_selected[i]) {
        ASSERT_TRUE(is_alive) << i;
      } else {
        ASSERT_FALSE(is_alive && meets) << i;
      }
    }
  }
}

}  // namespace
}  // namespace trapeze
