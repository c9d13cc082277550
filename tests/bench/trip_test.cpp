#include "bench/measure/trip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::Ge;
using ::testing::IsEmpty;
using ::testing::Le;
using ::testing::SizeIs;

Places places_of(const std::vector<Point>& points) {
  Places places{points, points, {}};
  for (const Point point : points) places.box.include(point);
  return places;
}

bool holds(const TileId& tile, Point point) {
  return point.x >= tile.origin_x() && point.x < tile.origin_x() + tile.side() &&
         point.y >= tile.origin_y() && point.y < tile.origin_y() + tile.side();
}

const Places kSome = places_of({{1000, 2000}, {5000000, -7000000}, {-90000000, 40000000}});

TEST(TripTest, AViewIsAsManyTilesAsAScreenCanTouch) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    // 1600 pixels are 6.25 tiles, 1200 are 4.69.
    EXPECT_THAT(make_trip(kSome, 12, 12, 1, {1600, 1200}, seed),
                SizeIs(AllOf(Ge(7u * 5u), Le(8u * 6u))));
  }
}

TEST(TripTest, EveryViewShowsAFeature) {
  for (const TileId& tile : make_trip(kSome, 15, 15, 1, {1, 1})) {
    EXPECT_TRUE(holds(tile, kSome.middles[0]) || holds(tile, kSome.middles[1]) ||
                holds(tile, kSome.middles[2]));
  }
}

TEST(TripTest, ATripEndsAtTheEdgeOfTheWorld) {
  const auto trip = make_trip(places_of({{kGridMin, kGridMin}}), 0, 3, 1);
  EXPECT_THAT(trip, Each(::testing::Truly([](const TileId& tile) { return tile.is_valid(); })));
  EXPECT_EQ(trip.front(), (TileId{0, 0, 0}));
}

TEST(TripTest, ATripIsTheSameEveryTimeAndAnotherForAnotherSeed) {
  EXPECT_EQ(make_trip(kSome, 10, 17, 9), make_trip(kSome, 10, 17, 9));
  EXPECT_NE(make_trip(kSome, 10, 17, 9, {}, 1), make_trip(kSome, 10, 17, 9, {}, 2));
}

TEST(TripTest, TilesOverABoxAreAllThatMeetIt) {
  const TileId corner{5, 10, 12};
  const auto x = static_cast<std::int32_t>(corner.origin_x());
  const auto y = static_cast<std::int32_t>(corner.origin_y());
  const auto side = static_cast<std::int32_t>(corner.side());
  const auto tiles = tiles_over({x, y, x + side, y + side - 1}, 5, 5);
  EXPECT_EQ(tiles, (std::vector<TileId>{{5, 10, 12}, {5, 11, 12}}));
}

TEST(TripTest, TilesAtVerticesHoldThemAndComeOnce) {
  const auto tiles = tiles_at_vertices(kSome, 0, 8, 5);
  std::set<std::pair<int, std::pair<std::uint32_t, std::uint32_t>>> seen;
  for (const TileId& tile : tiles) {
    EXPECT_TRUE(holds(tile, kSome.vertices[0]) || holds(tile, kSome.vertices[1]) ||
                holds(tile, kSome.vertices[2]));
    EXPECT_TRUE(seen.insert({tile.z, {tile.x, tile.y}}).second);
  }
  EXPECT_EQ(tiles.front(), (TileId{0, 0, 0}));
}

TEST(TripTest, ThereIsNoTripWithoutPolygons) {
  EXPECT_THROW(read_places({}), std::runtime_error);
  EXPECT_THROW(named_trip("nowhere", "."), std::runtime_error);
  EXPECT_THAT(trip_names(), ::testing::Not(IsEmpty()));
}

}  // namespace
}  // namespace trapeze
