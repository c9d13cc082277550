#include "core/mesh/seen_edges.h"

#include <gmock/gmock.h>

#include "core/mesh/visible_parts.h"

namespace trapeze {
namespace {

using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

// A square of 100 cells (edges 0 and 1, horizontal edges 4 and 5), and a triangle over it whose
// sides are edges 2 and 3.
const std::vector<Point> kVertices = {{0, 0},    {0, 100},  {100, 0}, {100, 100},
                                      {50, -50}, {-50, 50}, {150, 50}};
const std::vector<MeshEdge> kEdges = {{0, 1}, {2, 3}, {4, 5}, {4, 6}, {0, 2}, {1, 3}};
const std::vector<MeshTrapezoid> kTrapezoids = {{0, 3, 0, 1}, {4, 6, 2, 3}};
const MeshView kMesh{1, kVertices, kEdges, kTrapezoids};
const std::vector<std::uint32_t> kOwn = {0, 1};

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
  append_seen_sides(kMesh, kOwn, parts_below(0), seen);
  EXPECT_THAT(seen, UnorderedElementsAre(SeenEdge{0, {0, 50}, {0, 100}, 1},
                                         SeenEdge{1, {100, 50}, {100, 100}, 1}));
}

TEST(SeenEdgesTest, ThroughWhatIsNotOpaqueAShareIsSeen) {
  std::vector<SeenEdge> seen;
  append_seen_sides(kMesh, kOwn, parts_below(0.5F), seen);
  EXPECT_THAT(seen, UnorderedElementsAre(SeenEdge{0, {0, 0}, {0, 50}, 0.5F},
                                         SeenEdge{0, {0, 50}, {0, 100}, 1},
                                         SeenEdge{1, {100, 0}, {100, 50}, 0.5F},
                                         SeenEdge{1, {100, 50}, {100, 100}, 1}));
}

TEST(SeenEdgesTest, SoAreHorizontalEdges) {
  std::vector<SeenEdge> seen;
  append_seen_level_edge(kMesh, 4, parts_below(0), seen);
  EXPECT_THAT(seen, IsEmpty());
  append_seen_level_edge(kMesh, 5, parts_below(0), seen);
  EXPECT_THAT(seen, UnorderedElementsAre(SeenEdge{5, {0, 100}, {100, 100}, 1}));
}

TEST(SeenEdgesTest, SidesOfWhatLiesOverAreNotItsOwn) {
  std::vector<SeenEdge> seen;
  append_seen_sides(kMesh, std::vector<std::uint32_t>{0}, parts_below(0), seen);
  EXPECT_THAT(seen, UnorderedElementsAre(SeenEdge{0, {0, 50}, {0, 100}, 1}));
}

}  // namespace
}  // namespace trapeze
