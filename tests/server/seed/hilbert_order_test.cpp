#include "server/seed/hilbert_order.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trapeze {
namespace {

std::uint64_t id_of(const TileId& tile) {
  return first_id_of_zoom(tile.z) + place_on_curve(tile);
}

TEST(HilbertOrderTest, NumbersTilesAsTheSpecificationOfPmtilesDoes) {
  // The table in the specification.
  EXPECT_EQ(id_of({0, 0, 0}), 0u);
  EXPECT_EQ(id_of({1, 0, 0}), 1u);
  EXPECT_EQ(id_of({1, 0, 1}), 2u);
  EXPECT_EQ(id_of({1, 1, 1}), 3u);
  EXPECT_EQ(id_of({1, 1, 0}), 4u);
  EXPECT_EQ(id_of({2, 0, 0}), 5u);
  EXPECT_EQ(id_of({12, 3423, 1763}), 19'078'479u);
}

TEST(HilbertOrderTest, FindsATileByItsNumber) {
  for (int zoom = 0; zoom <= 6; ++zoom) {
    for (std::uint64_t place = 0; place < (std::uint64_t{1} << 2 * zoom); ++place) {
      EXPECT_EQ(place_on_curve(tile_at_place(zoom, place)), place);
    }
  }
  const TileId last{kMaxZoom, (1u << kMaxZoom) - 1, 12'345};
  EXPECT_EQ(tile_at_place(kMaxZoom, place_on_curve(last)), last);
}

TEST(HilbertOrderTest, TilesThatFollowEachOtherAreNeighbours) {
  constexpr int kZoom = 6;
  for (std::uint64_t place = 1; place < (std::uint64_t{1} << 2 * kZoom); ++place) {
    const TileId a = tile_at_place(kZoom, place - 1);
    const TileId b = tile_at_place(kZoom, place);
    EXPECT_EQ(std::abs(static_cast<int>(a.x) - static_cast<int>(b.x)) +
                  std::abs(static_cast<int>(a.y) - static_cast<int>(b.y)),
              1);
  }
}

TEST(HilbertOrderTest, TheTilesBelowATileFollowEachOther) {
  const TileId tile{3, 5, 2};
  std::uint64_t next = places_below(tile, 4).first;
  for (const TileId& child : children_in_order(tile)) {
    EXPECT_EQ(place_on_curve(child), next++);
    EXPECT_EQ(child.x / 2, tile.x);
    EXPECT_EQ(child.y / 2, tile.y);
  }
  EXPECT_EQ(places_below(tile, 4).count, 4u);
}

}  // namespace
}  // namespace trapeze
