// All contestants draw the same map; otherwise a comparison would be meaningless.
#include <gtest/gtest.h>

#include <cstdlib>

#include "bench/experiment/race.h"
#include "bench/experiment/trip.h"
#include "tests/experiment/sample_map.h"
#include "tests/render/masks.h"

namespace trapeze::experiment {
namespace {

// No vertex of the map is blocked, so topology makes no difference to it.
class ContestantsTest : public ::testing::TestWithParam<Method> {
 protected:
  static void expect_same(const std::vector<Mask>& drawn, const std::vector<Mask>& expected) {
    ASSERT_EQ(drawn.size(), expected.size());
    for (std::size_t layer = 0; layer < drawn.size(); ++layer) {
      const auto a = testing::values_of(drawn[layer]);
      const auto b = testing::values_of(expected[layer]);
      ASSERT_EQ(a.size(), b.size());
      int worst = 0;
      for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
      EXPECT_LE(worst, 2) << "layer " << layer;
    }
  }
  static bool shows_something(const std::vector<Mask>& masks) {
    for (const Mask& mask : masks) {
      if (!mask.is_all(0)) return true;
    }
    return false;
  }
  static bool shows_something_in_the_middle(const Mask& mask) {
    for (int y = mask.height() / 2; y < mask.height() / 2 + 3; ++y) {
      for (int x = mask.width() / 2 - 3; x < mask.width() / 2 + 3; ++x) {
        if (mask.at(x, y) > 0) return true;
      }
    }
    return false;
  }

  const Map map_ = sample_map(300);
  Screen screen_;
};

TEST_P(ContestantsTest, DrawTheSame) {
  for (const Topology topology : {Topology::strict, Topology::fast}) {
    if (!is_possible(GetParam(), topology, map_)) continue;
    const auto contestant = make_contestant(GetParam(), topology, map_, screen_);
    const auto expected = make_contestant(Method::lifespans, Topology::fast, map_, screen_);
    contestant->start_run();
    std::vector<Mask> drawn;
    std::vector<Mask> reference;
    // The uppermost vertex of a building: buildings are so far apart that the closest view around
    // any other position may contain none.
    const Point centre = map_.layers[1].polygons.rings[0][0];
    // Zooms in and out, so that graphs are adapted in both directions.
    for (const double scale : {50000., 8000., 3000., 8000., 120000., 3000.}) {
      const ScaledView view = view_around(map_, centre, scale, 800, 600, 1);
      const ViewCost cost = contestant->draw(view, drawn);
      expected->draw(view, reference);
      expect_same(drawn, reference);
      EXPECT_TRUE(shows_something(drawn)) << "scale " << scale;
      EXPECT_TRUE(scale > 8000 || shows_something_in_the_middle(drawn[1])) << "scale " << scale;
      EXPECT_GT(cost.trapezoids, 0u);
      EXPECT_GT(cost.bytes, 0u);
      EXPECT_GT(cost.total_ms(), 0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, ContestantsTest,
                         ::testing::Values(Method::douglas_peucker, Method::blg_tree,
                                           Method::triangulation, Method::whole_map,
                                           Method::adapting, Method::lifespans),
                         [](const auto& test) { return std::string(name_of(test.param)); });

TEST(DeviceTrapezoidsTest, MoreThanAChunkIsDrawn) {
  Screen screen;
  DeviceTrapezoids device(screen);
  TrapezoidList list;
  const Box everything{kGridMin, kGridMin, kGridMax, kGridMax};
  const auto count = static_cast<std::int32_t>(device.chunk_size() + 1000);
  // Slices one cell wide; 4096 of them make a pixel.
  for (std::int32_t x = 0; x < count; ++x) {
    list.append({0, 4096, {x, 0}, {x, 4096}, {x + 1, 0}, {x + 1, 4096}}, everything);
  }
  device.send(list);
  View view;
  view.cells_per_pixel = 4096;
  view.width = 128;
  view.height = 32;
  std::vector<Mask> masks;
  device.draw(std::vector<std::uint32_t>{static_cast<std::uint32_t>(count)}, view, masks);
  for (int x = 0; x < count / 4096; ++x) EXPECT_EQ(masks[0].at(x, 0), 255) << x;
  EXPECT_EQ(masks[0].at(count / 4096 + 1, 0), 0);
  EXPECT_EQ(masks[0].at(0, 1), 0);
}

TEST(RaceTest, CountsEveryViewOnceForEachContestant) {
  const Map map = sample_map(20);
  Screen screen;
  Race race(map, Topology::strict, screen, kMethods);
  const std::vector<ScaledView> trip{view_around(map, {0, 400000}, 50000, 160, 120, 0.25),
                                     view_around(map, {0, 400000}, 20000, 160, 120, 0.25)};
  race.run(trip, {.runs = 3});
  for (const RaceResult& result : race.results()) {
    EXPECT_EQ(result.views.size(), 2u);
    EXPECT_EQ(result.runs, is_for_reference(result.method) ? 1 : 3);
    EXPECT_GT(result.seconds, 0);
    for (const ViewCost& cost : result.views) EXPECT_GT(cost.total_ms(), 0);
  }
  const auto full = race.pictures(Method::no_simplification, trip);
  const PictureError none = compare(trip, full, full);
  EXPECT_GT(none.pixels, 0u);
  EXPECT_EQ(none.mean, 0);
  EXPECT_EQ(none.area, 0);
}

TEST(RaceTest, RunsOnceWhereThereIsNoTimeForMore) {
  const Map map = sample_map(20);
  Screen screen;
  const std::vector<Method> methods{Method::blg_tree, Method::lifespans};
  Race race(map, Topology::strict, screen, methods);
  const std::vector<ScaledView> trip{view_around(map, {0, 400000}, 50000, 160, 120, 0.25)};
  race.run(trip, {.runs = 3, .seconds = 0});
  ASSERT_EQ(race.results().size(), 2u);
  for (const RaceResult& result : race.results()) EXPECT_EQ(result.runs, 1);
}

}  // namespace
}  // namespace trapeze::experiment
