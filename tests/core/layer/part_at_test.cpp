#include "core/layer/part_at.h"

#include <gtest/gtest.h>

#include <vector>

namespace trapeze {
namespace {

void add_square(Rings& rings, std::int32_t middle, std::int32_t half) {
  rings.add(std::vector<Point>{{middle - half, -half},
                               {middle + half, -half},
                               {middle + half, half},
                               {middle - half, half}});
}

Box square_box(std::int32_t middle, std::int32_t half) {
  return {middle - half, -half, middle + half, half};
}

/// Land with a lake, an island in the lake with a pond, and an island off the coast.
Rings archipelago() {
  Rings rings;
  add_square(rings, 0, 100);
  add_square(rings, 300, 20);
  add_square(rings, 0, 60);
  add_square(rings, 0, 40);
  add_square(rings, 0, 10);
  return rings;
}

TEST(PartAtTest, IsTheOneThatHoldsThePoint) {
  const Rings rings = archipelago();
  EXPECT_EQ(part_at(rings, {80, 0}), square_box(0, 100));
  EXPECT_EQ(part_at(rings, {30, 0}), square_box(0, 40)) << "the island in the lake";
  EXPECT_EQ(part_at(rings, {300, 0}), square_box(300, 20));
}

TEST(PartAtTest, LeftAndTopBelongToItRightAndBottomDoNot) {
  Rings rings;
  add_square(rings, 0, 10);
  add_square(rings, 20, 10);
  EXPECT_EQ(part_at(rings, {10, 0}), square_box(20, 10)) << "where they touch";
  EXPECT_EQ(part_at(rings, {9, -10}), square_box(0, 10));
}

TEST(PartAtTest, OutsideOfAllItIsTheNearest) {
  const Rings rings = archipelago();
  EXPECT_EQ(part_at(rings, {270, 0}), square_box(300, 20));
  EXPECT_EQ(part_at(rings, {120, 0}), square_box(0, 100));
  EXPECT_EQ(part_at(rings, {58, 0}), square_box(0, 100)) << "in the lake, near its shore";
  EXPECT_EQ(part_at(rings, {42, 0}), square_box(0, 40)) << "in the lake, near the island";
  EXPECT_EQ(part_at(rings, {0, 0}), square_box(0, 40)) << "in the pond of the island";
}

TEST(PartAtTest, WithoutRingsThereIsNone) {
  EXPECT_TRUE(part_at({}, {0, 0}).is_empty());
}

TEST(PartAtTest, TheWholeGridIsNotTooLarge) {
  Rings rings;
  rings.add(std::vector<Point>{
      {kGridMin, kGridMin}, {kGridMax, kGridMin}, {kGridMax, kGridMax}, {kGridMin, kGridMax}});
  EXPECT_EQ(part_at(rings, {0, 0}), (Box{kGridMin, kGridMin, kGridMax, kGridMax}));
  EXPECT_EQ(part_at(rings, {kGridMax, kGridMax}), (Box{kGridMin, kGridMin, kGridMax, kGridMax}));
}

}  // namespace
}  // namespace trapeze
