#include "core/mesh/seen_edges.h"

#include <gmock/gmock.h>

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

TEST(SeenEdgesTest, SoAreHorizontalEdges) {
  std::vector<SeenEdge> seen;
  append_seen_level_edge(kMesh, 4, {parts_below(0), kBoxOfAll}, seen);
  EXPECT_THAT(seen, IsEmpty());
  append_seen_level_edge(kMesh, 5, {parts_below(0), kBoxOfAll}, seen);
  EXPECT_THAT(seen, UnorderedElementsAre(SeenEdge{5, {0, 100}, {100, 100}, 1}));
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
    std::vector<SeenEdge> seen;
    append_seen_level_edge(kMesh, 5, {parts, around}, seen);
    return seen;
  };
  EXPECT_THAT(level({20, 90, 40, 110}), ElementsAre(SeenEdge{5, {0, 100}, {100, 100}, 1}));
  EXPECT_THAT(level({20, 10, 40, 99}), IsEmpty());
  EXPECT_THAT(level({101, 90, 140, 110}), IsEmpty());
}

}  // namespace
}  // namespace trapeze
