#include "server/seed/known_tiles.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/server/seed/seeded_tiles.h"
#include "tests/server/tiles/edited_land.h"

namespace trapeze {
namespace {

using testing::seed_request;
using testing::SeededTiles;

/// Styles that draw beyond a polygon's boundary, or differently inside it.
const std::vector<std::string> kStyles = {
    "",
    "fill-opacity=0.4",
    "small=drop",
    "small=keep",
    "small=keep&fill-opacity=0.5",
    "stroke=black&stroke-width=1",
    "stroke=red&stroke-width=12&stroke-dasharray=6,3",
    "fill=none&stroke=blue&stroke-width=2",
    "fill-opacity=0.5&stroke=black&stroke-width=4&stroke-linejoin=miter",
    "pattern=hatch&pattern-color=black",
    "simplify=4",
    "smooth=60",
    "smooth=9&simplify=2&stroke=black&stroke-width=5",
    "grow=3",
    "grow=16&simplify=2&stroke=black&stroke-width=5",
    "simplify=0",
    "simplify=6&small=keep",
    "background=cfe8ff",
    "background=cfe8ff&fill-opacity=0.3&opacity=0.5",
    "quality=exact&fill-opacity=0.3",
};

TEST(KnownTilesTest, TilesOfRingsAreThoseOfTheServerInEveryStyle) {
  const auto dataset = testing::sample_dataset();
  for (const std::string& style : kStyles) {
    SCOPED_TRACE(style);
    const auto plan = SeedPlan::make(seed_request(*dataset, {0, 6}, style), dataset);
    testing::expect_served_bytes(*plan);
  }
}

TEST(KnownTilesTest, TilesOfLandByChanceAreThoseOfTheServer) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    testing::EditedLand land(seed);
    const auto dataset = land.load();
    std::vector<std::string> styles = kStyles;
    styles.insert(styles.end(),
                  {"color-by=kind&classes=field:gold,wood:green&small=keep",
                   "color-by=kind&classes=field:gold,wood:green&stroke=black", "filter=kind='wood'",
                   "filter=kind='pond'&fill-opacity=0.4", "ids=3&highlight=3&highlight-fill=red"});
    for (const std::string& style : styles) {
      SCOPED_TRACE(style + ", seed " + std::to_string(seed));
      auto request = seed_request(*dataset, {3, 9}, style);
      request.bbox = GeographicBounds{-12, -12, 35, 22};
      const auto plan = SeedPlan::make(request, dataset);
      testing::expect_served_bytes(*plan);
    }
  }
}

TEST(KnownTilesTest, TilesOfAScaleAndAFormatAreThoseOfTheServer) {
  const auto dataset = testing::sample_dataset();
  auto request = seed_request(*dataset, {1, 4}, "stroke=black");
  request.tile.scale = 2;
  request.tile.format = TileFormat::webp;
  const auto plan = SeedPlan::make(request, dataset);
  testing::expect_served_bytes(*plan);
}

TEST(KnownTilesTest, LayersOfSomeZoomsOnlyAreSeenThereOnly) {
  const auto all = testing::sample_dataset();
  std::vector<ServedLayer> layers = all->layers_on_all_grids();
  layers[0].config.min_zoom = 3;
  layers[1].config.max_zoom = 4;
  const auto dataset = std::make_shared<const Dataset>(layers);
  const auto plan = SeedPlan::make(seed_request(*dataset, {0, 6}, "fill-opacity=0.5"), dataset);
  testing::expect_served_bytes(*plan);
}

TEST(KnownTilesTest, ALayerThatBeginsLaterStillLiesOverThoseBelowIt) {
  const auto all = testing::sample_dataset();
  std::vector<ServedLayer> layers = all->layers_on_all_grids();
  layers[1].config.min_zoom = 3;
  layers[1].config.max_zoom = 6;
  const auto dataset = std::make_shared<const Dataset>(layers);
  const auto plan = SeedPlan::make(seed_request(*dataset, {0, 6}, "fill-opacity=1"), dataset);
  testing::expect_served_bytes(*plan);
}

TEST(KnownTilesTest, MostTilesAreNotLookedAt) {
  const auto dataset = testing::sample_dataset();
  const auto plan = SeedPlan::make(seed_request(*dataset, {0, 9}, "stroke=black"), dataset);
  const SeededTiles seeded(*plan);
  // Only tiles along boundaries are drawn: the sides of the squares pass through some thousand
  // tiles.
  EXPECT_LT(seeded.figures().drawn + seeded.figures().alone, plan->count() / 40);
  EXPECT_GT(seeded.figures().drawn, 1000u);
  EXPECT_LT(seeded.figures().alone, seeded.figures().drawn / 10);
}

TEST(KnownTilesTest, JobsAreSmallWhateverKeepsTilesFromBeingKnown) {
  const auto dataset = testing::sample_dataset();
  for (const char* const style : {"stroke=black", "pattern=hatch", "debug=tile"}) {
    SCOPED_TRACE(style);
    const auto plan = SeedPlan::make(seed_request(*dataset, {0, 6}, style), dataset);
    const SeededTiles seeded(*plan);
    const SeedFigures& figures = seeded.figures();
    EXPECT_GE(static_cast<double>(seeded.jobs().jobs.size()),
              static_cast<double>(figures.drawn + figures.alone) / (3 * kTilesOfJob));
  }
}

TEST(KnownTilesTest, NothingIsKnownOfTilesThatAreMarked) {
  const auto dataset = testing::sample_dataset();
  const auto plan = SeedPlan::make(seed_request(*dataset, {0, 3}, "debug=tile"), dataset);
  KnownTiles known(*plan, TilePainter::new_class_cache(), std::make_shared<LabelBook>());
  known.look_at({0, 0, 0});
  EXPECT_FALSE(known.look_at_zoom(0).has_value());
  testing::expect_served_bytes(*plan);
}

}  // namespace
}  // namespace trapeze
