#include "server/tiles/map_window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace trapeze {
namespace {

constexpr double kWorld = static_cast<double>(kGridSize);

WindowSides sides_of(const TileId& tile) {
  const auto west = static_cast<double>(tile.origin_x());
  const auto north = static_cast<double>(tile.origin_y());
  const auto side = static_cast<double>(tile.side());
  return {west, north, west + side, north + side};
}

void expect_equal(const View& a, const View& b) {
  EXPECT_EQ(a.origin_x, b.origin_x);
  EXPECT_EQ(a.origin_y, b.origin_y);
  EXPECT_EQ(a.cells_per_pixel, b.cells_per_pixel);
  EXPECT_EQ(a.stretch, b.stretch);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
}

TEST(MapWindowTest, TheWindowOfATileIsItsView) {
  for (int zoom = 0; zoom <= kMaxZoom; ++zoom) {
    const TileId tile{zoom, (1u << zoom) / 3, (1u << zoom) / 5};
    for (const int scale : {1, 2, 3, 4}) {
      WindowSides sides = sides_of(tile);
      sides.west += 0.3;  // as far as the numbers in a request may be off those of the grid
      sides.south -= 0.4;
      const auto view = view_of_window(sides, kTilePixels * scale, kTilePixels * scale);
      ASSERT_TRUE(view);
      expect_equal(*view, View::of_tile(tile, scale));
      EXPECT_EQ(zoom_of(*view, scale), zoom);
    }
  }
}

TEST(MapWindowTest, NoPlaceMovesByMoreThanHalfACell) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(kGridMin, kGridMax);
  for (int i = 0; i < 10'000; ++i) {
    const double west = place(random);
    const double north = place(random);
    const double size = std::exp2(std::uniform_real_distribution<double>(10, 30)(random));
    const WindowSides sides{west, north, west + size * 1.7, north + size};
    const int width = 1 + static_cast<int>(random() % 16384);
    const int height = 1 + static_cast<int>(random() % 16384);
    const auto view = view_of_window(sides, width, height);
    ASSERT_TRUE(view);
    for (const double part : {0.0, 0.25, 1.0}) {
      const double x = static_cast<double>(view->origin_x) + part * width * view->cells_per_pixel;
      const double y = static_cast<double>(view->origin_y) + part * height * view->cells_per_row();
      EXPECT_NEAR(x, sides.west + part * sides.width(), 0.501);
      EXPECT_NEAR(y, sides.north + part * sides.height(), 0.501);
    }
  }
}

TEST(MapWindowTest, AWindowAroundTheWorldIsBroughtHome) {
  const auto home = view_of_window({-1000, -500, 1000, 500}, 200, 100);
  for (const int worlds : {-7, -1, 1, 7}) {
    const double away = worlds * kWorld;
    const auto view = view_of_window({away - 1000, -500, away + 1000, 500}, 200, 100);
    ASSERT_TRUE(view);
    expect_equal(*view, *home);
  }
}

TEST(MapWindowTest, RefusesWindowsWithoutASizeAndThoseFarAway) {
  const double far = kMostWorlds * kWorld * 1.01;
  for (const WindowSides& sides :
       {WindowSides{0, 0, 0.2, 100}, WindowSides{0, 0, 100, 0.2}, WindowSides{5, 0, 0, 100},
        WindowSides{0, 0, far, 100}, WindowSides{-far, 0, 0, 100}, WindowSides{0, -far, 100, 100},
        WindowSides{0, 0, NAN, 100}, WindowSides{0, 0, INFINITY, 100}}) {
    EXPECT_FALSE(view_of_window(sides, 10, 10));
  }
}

TEST(MapWindowTest, TheWorldIsSeenAsOftenAsTheWindowReachesIt) {
  const auto copies_from = [](double west, double east) {
    return views_of_copies(*view_of_window({west, 0, east, 1000}, 100, 100));
  };
  EXPECT_EQ(copies_from(kGridMin, kGridMax).size(), 1u);
  EXPECT_EQ(copies_from(-10, 10).size(), 1u);
  const auto two = copies_from(kGridMax - 1000, kGridMax + 1000);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].origin_x, kGridMax - 1000);
  EXPECT_EQ(two[1].origin_x, kGridMin - 1000);
  EXPECT_EQ(copies_from(-kWorld, 2 * kWorld).size(), 4u);
}

TEST(MapWindowTest, LinesReachIntoThePictureFromTheNextCopyOfTheWorld) {
  const View at_the_east = View::of_tile({3, 7, 2});
  ASSERT_EQ(views_of_copies(at_the_east).size(), 1u);
  const auto views = views_of_copies(at_the_east, 4.5);
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[0].origin_x, at_the_east.origin_x);
  EXPECT_EQ(views[1].origin_x, at_the_east.origin_x - kGridSize);
  EXPECT_EQ(views_of_copies(View::of_tile({3, 0, 2}), 4.5).size(), 2u);
  EXPECT_EQ(views_of_copies(View::of_tile({3, 1, 2}), 4.5).size(), 1u);
  EXPECT_EQ(views_of_copies(View::of_tile({0, 0, 0}), 4.5).size(), 3u);
}

TEST(MapWindowTest, AroundAPlaceIsWhereTheTileIs) {
  const TileId tile{5, 17, 11};
  const WindowSides sides = sides_of(tile);
  const GridPosition middle{(sides.west + sides.east) / 2, (sides.north + sides.south) / 2};
  for (const int scale : {1, 2, 4}) {
    expect_equal(view_around(middle, 5, kTilePixels * scale, kTilePixels * scale, scale),
                 View::of_tile(tile, scale));
  }
}

TEST(MapWindowTest, OfPixelsThatAreNotSquareTheShorterSideHasTheZoom) {
  const auto view = view_of_window({0, 0, 1 << 20, 1 << 20}, 256, 512);
  EXPECT_EQ(zoom_of(*view, 1), 12);
}

}  // namespace
}  // namespace trapeze
