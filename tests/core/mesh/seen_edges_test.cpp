#include "core/mesh/seen_edges.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <vector>

#include "core/mesh/visible_parts.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

// A square of 100 cells (edges 0 and 1, horizontal edges 4 and 5), and a triangle over it with the
// sides 2 and 3.
const std::vector<Point> kVertices = {{0, 0},    {0, 100},  {100, 0}, {100, 100},
                                      {50, -50}, {-50, 50}, {150, 50}};
const std::vector<MeshEdge> kEdges = {{0, 1}, {2, 3}, {4, 5}, {4, 6}, {0, 2}, {1, 3}};
const std::vector<MeshTrapezoid> kTrapezoids = {{0, 3, 0, 1}, {4, 6, 2, 3}};
const MeshView kMesh{1, kVertices, kEdges, kTrapezoids};
const std::vector<std::uint32_t> kOwn = {0, 1};

constexpr Box kBoxOfAll{-200, -200, 200, 200};

std::vector<TrapezoidPart> parts_below(float share) {
  Sheet triangle;
  triangle.assign(kMesh, std::vector<std::uint32_t>{1});
  VisibleParts visible;
  CancellationCheck check(nullptr, 100);
  visible.begin(kMesh);
  visible.add(0);
  visible.cover(triangle, share, check);
  return {visible.parts().begin(), visible.parts().end()};
}

TEST(SeenEdgesTest, SidesAreSeenWhereTheInsideIs) {
  std::vector<SeenEdge> seen;
  append_seen_sides(kMesh, kOwn, {parts_below(0), kBoxOfAll}, seen);
  EXPECT_THAT(seen, UnorderedElementsAre(SeenEdge{0, {0, 50}, {0, 100}, 1},
                                         SeenEdge{1, {100, 50}, {100, 100}, 1}));
}

TEST(SeenEdgesTest, ThroughWhatIsNotOpaqueAShareIsSeen) {
  std::vector<SeenEdge> seen;
  append_seen_sides(kMesh, kOwn, {parts_below(0.5F), kBoxOfAll}, seen);
  EXPECT_THAT(seen, UnorderedElementsAre(SeenEdge{0, {0, 0}, {0, 50}, 0.5F},
                                         SeenEdge{0, {0, 50}, {0, 100}, 1},
                                         SeenEdge{1, {100, 0}, {100, 50}, 0.5F},
                                         SeenEdge{1, {100, 50}, {100, 100}, 1}));
}

std::vector<SeenEdge> seen_level_edges(const MeshView& mesh,
                                       const std::vector<std::uint32_t>& edges,
                                       const VisibleInBox& visible) {
  std::vector<SeenEdge> seen;
  append_seen_level_edges(mesh, edges, visible, seen);
  return seen;
}

TEST(SeenEdgesTest, SoAreHorizontalEdges) {
  EXPECT_THAT(seen_level_edges(kMesh, {4}, {parts_below(0), kBoxOfAll}), IsEmpty());
  EXPECT_THAT(seen_level_edges(kMesh, {4, 5}, {parts_below(0), kBoxOfAll}),
              ElementsAre(SeenEdge{5, {0, 100}, {100, 100}, 1}));
}

TEST(SeenEdgesTest, ManyHorizontalEdgesAreSeenAsEachAlone) {
  // Rows of columns of visible parts, and horizontal edges of any length at their tops and bottoms.
  std::mt19937 random(4);
  const auto number_to = [&](int most) {
    return static_cast<std::int32_t>(random() % static_cast<unsigned>(most));
  };
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<TrapezoidPart> parts;
  const auto add_edge = [&](Point upper, Point lower) {
    const auto v = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), {upper, lower});
    edges.push_back({v, v + 1});
    return static_cast<std::uint32_t>(edges.size() - 1);
  };
  for (std::int32_t row = 0; row < 8; ++row) {
    for (std::int32_t column = 0; column < 30; ++column) {
      const std::int32_t west = 100 * column + number_to(40);
      const std::int32_t east = 100 * column + 60 + number_to(40);
      const std::uint32_t left =
          add_edge({west, 100 * row}, {west + number_to(9), 100 * row + 100});
      const std::uint32_t right = add_edge({east, 100 * row}, {east, 100 * row + 100});
      const float share = column % 7 == 0 ? 0.5F : 1.0F;
      if (number_to(4) > 0) parts.push_back({100 * row, 100 * row + 100, left, right, share});
    }
  }
  std::ranges::shuffle(parts, random);
  std::vector<std::uint32_t> level;
  for (int i = 0; i < 200; ++i) {
    const std::int32_t y = 100 * number_to(10);
    const std::int32_t west = number_to(3'000);
    level.push_back(add_edge({west, y}, {west + 1 + number_to(400), y}));
  }
  const MeshView mesh{2, vertices, edges, {}};
  const VisibleInBox visible{parts, {50, 50, 2'500, 800}};
  std::vector<SeenEdge> each;
  for (const std::uint32_t edge : level) {
    const Point from = vertices[edges[edge].upper];
    const Point to = vertices[edges[edge].lower];
    for (SeenEdge one : seen_level_edges(mesh, {edge}, visible)) {
      EXPECT_TRUE(one.from.x >= from.x && one.to.x <= to.x && one.from.x < one.to.x);
      each.push_back(one);
    }
    // A place of the edge within the box is seen exactly if a part begins or ends there.
    for (std::int32_t x = std::max(from.x, 51); x < std::min(to.x, 2'499); x += 7) {
      const auto has_side = [&](const TrapezoidPart& part) {
        const bool is_level = part.top == from.y || part.bottom == from.y;
        return is_level && EdgeLine(mesh, part.left).x_at(from.y) < x &&
               x + 1 < EdgeLine(mesh, part.right).x_at(from.y);
      };
      const auto is_there = [&](const SeenEdge& one) {
        return one.edge == edge && one.from.x <= x && one.to.x > x;
      };
      if (from.y < 50 || from.y > 800 || !std::ranges::any_of(parts, has_side)) continue;
      EXPECT_TRUE(std::ranges::any_of(each, is_there)) << x << "," << from.y;
    }
  }
  EXPECT_GT(each.size(), 100u);
  EXPECT_EQ(seen_level_edges(mesh, level, visible), each);
}

TEST(SeenEdgesTest, SidesOfWhatLiesOverAreNotItsOwn) {
  std::vector<SeenEdge> seen;
  append_seen_sides(kMesh, std::vector<std::uint32_t>{0}, {parts_below(0), kBoxOfAll}, seen);
  EXPECT_THAT(seen, UnorderedElementsAre(SeenEdge{0, {0, 50}, {0, 100}, 1}));
}

TEST(SeenEdgesTest, WhereTheyEndBeyondTheBoxDoesNotMatter) {
  // The sides are visible only below 50.
  const std::vector<TrapezoidPart> parts = parts_below(0);
  const auto seen_in = [&](const Box& box, const std::vector<TrapezoidPart>& visible) {
    std::vector<SeenEdge> seen;
    append_seen_sides(kMesh, kOwn, {visible, box}, seen);
    return seen;
  };
  const Box box{-20, 40, 50, 70};
  EXPECT_THAT(seen_in(box, parts), ElementsAre(SeenEdge{0, {0, 50}, {0, 100}, 1}));
  EXPECT_THAT(seen_in(box, {{50, 80, 0, 1, 1}}), ElementsAre(SeenEdge{0, {0, 50}, {0, 100}, 1}));
  EXPECT_THAT(seen_in({-20, 60, 50, 70}, parts), ElementsAre(SeenEdge{0, {0, 0}, {0, 100}, 1}));
  EXPECT_THAT(seen_in({-20, 10, 50, 50}, parts), IsEmpty()) << "it begins where the box ends";
  EXPECT_THAT(seen_in({1, 0, 99, 100}, parts), IsEmpty());
}

TEST(SeenEdgesTest, NorDoesItForSlantedAndHorizontalOnes) {
  // The triangle alone, and its left side, which runs from (50, -50) to (-50, 50).
  const auto slanted = [](const Box& box, std::int32_t top, std::int32_t bottom) {
    const std::vector<TrapezoidPart> parts = {{top, bottom, 2, 3, 1}};
    std::vector<SeenEdge> seen;
    append_seen_sides(kMesh, std::vector<std::uint32_t>{2}, {parts, box}, seen);
    return seen;
  };
  const Box box{-10, -100, 10, 100};  // crosses this box from -10 to 10
  EXPECT_THAT(slanted(box, -30, 20), ElementsAre(SeenEdge{2, {50, -50}, {-50, 50}, 1}));
  EXPECT_THAT(slanted(box, -5, 20), ElementsAre(SeenEdge{2, {5, -5}, {-50, 50}, 1}));
  EXPECT_THAT(slanted(box, -40, 6), ElementsAre(SeenEdge{2, {50, -50}, {-6, 6}, 1}));
  EXPECT_THAT(slanted(box, 10, 50), IsEmpty());
  EXPECT_THAT(slanted({20, 20, 40, 40}, -50, 50), IsEmpty());

  const auto level = [](const Box& around) {
    const std::vector<TrapezoidPart> parts = {{50, 100, 0, 1, 1}};
    return seen_level_edges(kMesh, {5}, {parts, around});
  };
  EXPECT_THAT(level({20, 90, 40, 110}), ElementsAre(SeenEdge{5, {0, 100}, {100, 100}, 1}));
  EXPECT_THAT(level({20, 10, 40, 99}), IsEmpty());
  EXPECT_THAT(level({101, 90, 140, 110}), IsEmpty());
}

}  // namespace
}  // namespace trapeze
