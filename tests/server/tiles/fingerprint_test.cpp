// Fingerprints of tiles: tiles with equal fingerprints have equal bytes, however the layer was
// edited, and changes that are not visible do not affect them.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "render/make_renderer.h"
#include "render/software/software_renderer.h"
#include "server/base/content_hash.h"
#include "server/config/load_config.h"
#include "server/tiles/tile_painter.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/service/sample_site.h"
#include "tests/server/tiles/edited_land.h"

namespace trapeze {
namespace {

TilePlan plan_of(const std::shared_ptr<const Dataset>& dataset, const std::string& target) {
  const auto parsed = parse_tiles_target(split_target("/tiles/" + target).value(), StyleBook());
  return *plan_tile(std::get<TileRequest>(*parsed), dataset);
}

class FingerprintTest : public ::testing::TestWithParam<RendererKind> {
 protected:
  void SetUp() override {
    painter_ = std::make_unique<TilePainter>(make_renderer({GetParam(), {}}).renderer);
  }

  PaintedTile paint(const std::shared_ptr<const Dataset>& dataset, const std::string& target) {
    const TilePlan plan = plan_of(dataset, target);
    const PaintJob job{&plan};
    PaintedTile tile = painter_->paint({&job, 1}).front().value();
    EXPECT_EQ(painter_->identify(job), tile.fingerprint) << target;
    return tile;
  }
  std::string fingerprint(const std::shared_ptr<const Dataset>& dataset,
                          const std::string& target) {
    return paint(dataset, target).fingerprint;
  }

  /// Records the bytes for the tile's fingerprint; returns whether they equal the bytes recorded
  /// before.
  bool are_bytes_of_fingerprint(const PaintedTile& tile) {
    return *bytes_of_.emplace(tile.fingerprint, tile.bytes).first->second == *tile.bytes;
  }

  std::unique_ptr<TilePainter> painter_;
  std::map<std::string, std::shared_ptr<const std::string>> bytes_of_;
};

const std::vector<std::string> kStyles = {
    ".png",
    ".png?fill=green&fill-opacity=0.5",
    ".png?color-by=kind&classes=field:tan,wood:green,pond:blue",
    ".png?color-by=value&breaks=1,3&ramp=Blues&quality=exact",
    ".png?stroke=black&stroke-width=1.5&fill=tan",
    ".png?stroke=black&stroke-width=3&stroke-linejoin=miter&fill-opacity=0",
    ".png?stroke=red&stroke-width=2&stroke-dasharray=5,3",
    ".png?pattern=hatch&pattern-color=black",
    ".png?filter=kind='wood'&small=keep",
    ".png?color-by=kind&classes=field:tan,wood:green&smooth=12",
    ".png?stroke=black&smooth=30&simplify=2",
    ".png?color-by=kind&classes=field:tan,wood:green&grow=6",
    ".png?stroke=black&grow=3&small=dust",
    ".png?highlight=3,50&simplify=3",
    "@2x.png?simplify=0",
};

/// A random tile of the land or near it.
std::string random_tile(std::mt19937& random) {
  const int z = std::uniform_int_distribution<int>(0, 9)(random);
  const double longitude = std::uniform_real_distribution<double>(-5, 25)(random);
  const double latitude = std::uniform_real_distribution<double>(-5, 15)(random);
  const double tiles = 1 << z;
  const auto place = [tiles](double share) { return static_cast<int>(share * tiles); };
  return "land/" + std::to_string(z) + "/" + std::to_string(place((longitude + 180) / 360)) + "/" +
         std::to_string(place(0.5 - latitude / 360));
}

// A wrong byte here means that a client keeps showing an outdated tile.
TEST_P(FingerprintTest, TilesOfOneFingerprintHaveTheSameBytesThroughAllEdits) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  testing::EditedLand land(seed);
  std::vector<std::string> targets;
  for (int i = 0; i < 150; ++i) {
    targets.push_back(random_tile(random) + kStyles[static_cast<std::size_t>(i) % kStyles.size()]);
  }
  std::map<std::string, PaintedTile> before;
  int as_before = 0;
  int kept = 0;  // the ones among these with the same fingerprint
  for (int round = 0; round < 12; ++round) {
    const auto dataset = land.load();
    for (const std::string& target : targets) {
      const PaintedTile tile = paint(dataset, target);
      ASSERT_TRUE(are_bytes_of_fingerprint(tile)) << target << ", round " << round;
      if (round > 0 && *before[target].bytes == *tile.bytes) {
        ++as_before;
        kept += before[target].fingerprint == tile.fingerprint ? 1 : 0;
      }
      before[target] = tile;
    }
    land.edit();
  }
  EXPECT_GT(as_before, 1000);
  // The others have a change that is too small for any pixel, mostly far from the land.
  EXPECT_GT(kept, as_before * 4 / 5);
}

TEST_P(FingerprintTest, WhatIsNotSeenDoesNotMatter) {
  testing::EditedLand land(5);
  const auto dataset = land.load();
  const std::string tile = "land/5/16/15.png";
  const auto same = [&](const std::string& one, const std::string& other) {
    return fingerprint(dataset, one) == fingerprint(dataset, other);
  };
  EXPECT_TRUE(same(tile, tile + "?_=7"));
  EXPECT_TRUE(same(tile + "?filter=kind='wood'", tile + "?filter=kind='wood'%20AND%20value<9"));
  EXPECT_TRUE(
      same(tile + "?filter=kind='wood'&fill=red", tile + "?color-by=kind&classes=wood:red,*:0000"));
  EXPECT_FALSE(same(tile, tile + "?filter=kind='wood'"));
  EXPECT_FALSE(same(tile, "land/5/16/15.webp"));
  EXPECT_FALSE(same(tile, "land/5/16/15@2x.png"));
  EXPECT_FALSE(same(tile, tile + "?background=white"));
  EXPECT_FALSE(same(tile, tile + "?quality=exact"));
}

// Pictures of the same pixels, with lines and patterns of another width.
TEST_P(FingerprintTest, TheScaleOfLinesAndPatternsMatters) {
  testing::EditedLand land(5);
  const auto dataset = land.load();
  for (const char* style : {"?stroke=black&stroke-width=3", "?pattern=hatch&pattern-color=black"}) {
    TilePlan plan = plan_of(dataset, std::string("land/3/4/3@2x.png") + style);
    const std::string of_tile = painter_->identify({&plan});
    plan.scale = 1;
    EXPECT_NE(painter_->identify({&plan}), of_tile) << style;
  }
}

TEST_P(FingerprintTest, EmptyTilesAndFullOnesAreAllAlike) {
  testing::EditedLand land(5);
  const auto dataset = land.load();
  EXPECT_EQ(fingerprint(dataset, "land/3/0/0.png"), fingerprint(dataset, "land/9/300/100.png"));
  EXPECT_NE(fingerprint(dataset, "land/3/0/0.png"), fingerprint(dataset, "land/3/0/0@2x.png"));
  const PaintedTile full = paint(dataset, "land/12/2100/2010.png?fill=red");
  ASSERT_EQ(full.hint, TileHint::full);
  EXPECT_EQ(fingerprint(dataset, "land/13/4201/4021.png?fill=red"), full.fingerprint);
  EXPECT_NE(fingerprint(dataset, "land/13/4201/4021.png?fill=blue"), full.fingerprint);
}

TEST_P(FingerprintTest, LinesThatPassByDoNotMatter) {
  const TemporaryFolder folder;
  const std::string triangle = folder.write("land.geojson", R"({"type": "Polygon", "coordinates":
      [[[0, 0], [40, 0], [0, 40], [0, 0]]]})");
  const auto dataset = Dataset::load(layers_of_files({triangle}));
  for (const char* tile :
       {"land/8/131/124", "land/8/155/100"}) {  // within, and beyond the long side
    const std::string target = std::string(tile) + ".png";
    EXPECT_EQ(fingerprint(dataset, target + "?stroke=black"), fingerprint(dataset, target));
  }
  const std::string on_side = "land/8/142/113.png";
  EXPECT_NE(fingerprint(dataset, on_side + "?stroke=black"), fingerprint(dataset, on_side));
}

TEST_P(FingerprintTest, OtherLayersAndNamesDoNotMatter) {
  testing::EditedLand land(5);
  auto layers = layers_of_files({land.write(), testing::fixture("west.geojson")});
  layers[0].name = "meadows";
  const std::string tile = "/5/16/15.png?fill=green";
  EXPECT_EQ(fingerprint(Dataset::load(layers), "meadows" + tile),
            fingerprint(land.load(), "land" + tile));
}

// What one layer has on both sides of the antimeridian adds up; a layer lies over another one.
TEST_P(FingerprintTest, CopiesOfALayerAreNotLayersOverEachOther) {
  const TemporaryFolder folder;
  const auto features = [](const std::string& polygons) {
    return R"({"type": "MultiPolygon", "coordinates": [)" + polygons + "]}";
  };
  const std::string west = "[[[160, 10], [180, 10], [180, 35], [160, 35], [160, 10]]]";
  const std::string east = "[[[-179.9, 5], [-170, 5], [-170, 40], [-179.9, 40], [-179.9, 5]]]";
  const auto dataset = Dataset::load(layers_of_files(
      {folder.write("west.geojson", features(west)), folder.write("east.geojson", features(east)),
       folder.write("both.geojson", features(west + ", " + east))}));
  const std::string style = "/3/7/3.png?fill=blue&stroke=red&stroke-width=10";
  const PaintedTile one = paint(dataset, "both" + style);
  const PaintedTile two = paint(dataset, "east,west" + style);
  EXPECT_NE(*one.bytes, *two.bytes);
  EXPECT_NE(one.fingerprint, two.fingerprint);
}

// Of the copy of the world beside the picture, only a line reaches into it.
TEST_P(FingerprintTest, LinesFromBeyondTheAntimeridianLeaveTheFill) {
  const TemporaryFolder folder;
  std::string polygons;
  for (const std::string x : {"-180", "177"}) {
    const std::string end = x == "177" ? "180" : "-177";
    for (const auto& [south, north] : {std::pair("-14", "-8.5"), std::pair("-8.5", "-5")}) {
      const std::string start = x + ", " + south + "]";
      polygons += (polygons.empty() ? "" : ",") +
                  (R"({"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", )"
                   R"("coordinates": [[[)" +
                   start + ", [" + end + ", " + south + "], [" + end + ", " + north + "], [" + x +
                   ", " + north + "], [" + start + "]]}}");
    }
  }
  const std::string text = R"({"type": "FeatureCollection", "features": [)" + polygons + "]}";
  const auto dataset = Dataset::load(layers_of_files({folder.write("grid.geojson", text)}));
  for (const std::string tile : {"grid/7/0/67.png", "grid/7/127/67.png"}) {
    EXPECT_EQ(*paint(dataset, tile + "?fill=blue&stroke=blue").bytes,
              *paint(dataset, tile + "?fill=blue").bytes)
        << tile;
  }
}

TEST_P(FingerprintTest, MarksAreOfOneTileAndLayer) {
  testing::EditedLand land(5);
  const auto dataset = land.load();
  EXPECT_NE(fingerprint(dataset, "land/3/0/0.png?debug=tile"),
            fingerprint(dataset, "land/9/300/100.png?debug=tile"));
}

TEST_P(FingerprintTest, ATileThatIsNotWantedIsNotPainted) {
  testing::EditedLand land(5);
  const TilePlan plan = plan_of(land.load(), "land/5/16/15.png");
  const TilePlan other = plan_of(land.load(), "land/5/16/15.png?fill=red");
  std::string asked;
  const std::vector<PaintJob> jobs = {{&plan, nullptr,
                                       [&](const std::string& fingerprint) {
                                         asked = fingerprint;
                                         return false;
                                       }},
                                      {&other, nullptr, [](const std::string&) { return true; }},
                                      {&plan}};
  const auto tiles = painter_->paint(jobs);
  EXPECT_EQ(tiles[0]->bytes, nullptr);
  EXPECT_EQ(tiles[0]->fingerprint, asked);
  EXPECT_EQ(tiles[2]->fingerprint, asked);
  EXPECT_NE(tiles[2]->bytes, nullptr);
  EXPECT_EQ(*tiles[1]->bytes, *paint(other.dataset, "land/5/16/15.png?fill=red").bytes);
}

// If this fails because the bytes of tiles have changed, raise kPictureVersion and record the new
// digest: otherwise clients would keep showing old tiles, whose tags would still match.
TEST(PictureVersion, IsThatOfTheBytesOfTiles) {
  constexpr int kVersion = 3;
  constexpr const char* kBytes = "47f35c86a95badc979c68d745e8c1973";
  TilePainter painter(std::make_unique<SoftwareRenderer>());
  const auto dataset = testing::sample_dataset();
  ContentHash hash;
  for (const char* target :
       {"rings/0/0/0.png", "rings,west/1/0/0@2x.png", "rings/3/5/3.png?fill-opacity=0.4",
        "rings/0/0/0.png?stroke=black&stroke-width=2.5&stroke-dasharray=7,3",
        "rings,west/0/0/0.png?stroke=black&stroke-width=3&simplify=0",
        "west/1/0/0.png?pattern=dots&pattern-color=navy", "rings/2/1/1.png?simplify=6&small=keep",
        "rings,west/0/0/0@4x.png?quality=exact"}) {
    const TilePlan plan = plan_of(dataset, target);
    const PaintJob job{&plan};
    hash.add(*painter.paint({&job, 1}).front().value().bytes);
  }
  EXPECT_EQ(kVersion, kPictureVersion);
  EXPECT_EQ(hash.hex(), kBytes);
}

std::string renderer_name(const ::testing::TestParamInfo<RendererKind>& kind) {
  return kind.param == RendererKind::software ? "Software" : "Egl";
}

INSTANTIATE_TEST_SUITE_P(Renderers, FingerprintTest,
                         ::testing::Values(RendererKind::software, RendererKind::egl),
                         renderer_name);

}  // namespace
}  // namespace trapeze
