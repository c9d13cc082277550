// A layer that is prepared in parts is served like the layer that is built as a whole.
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/io/load/source_division.h"
#include "core/io/prepared/join_parts.h"
#include "core/io/prepared/prepared_layer.h"
#include "render/picture/picture.h"
#include "render/software/software_renderer.h"
#include "server/changes/changed_tiles.h"
#include "server/config/load_config.h"
#include "server/data/dataset.h"
#include "server/data/layer_damage.h"
#include "server/data/layer_summary.h"
#include "server/tiles/tile_painter.h"
#include "server/tiles/tile_plan.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/seed/seeded_tiles.h"

namespace trapeze {
namespace {

/// Villages of houses, some with shared walls, some overlapping, with a wood and a pond here and
/// there, in degrees.
class Villages {
 public:
  explicit Villages(std::uint32_t seed) : random_(seed) {
    for (int village = 0; village < 60; ++village) add_village();
  }

  std::string geojson() const {
    return fmt::format(R"({{"type":"FeatureCollection","features":[{}]}})",
                       fmt::join(features_, ",\n"));
  }

 private:
  double next(double range) { return range * static_cast<double>(random_() % 1'000'000) / 1e6; }

  void add_village() {
    const double x = 14 + next(1.5);
    const double y = 46 + next(1);
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) {
        // Houses in every other row share their walls.
        const double width = row % 2 == 0 ? 4e-4 : 1e-4 + next(2e-4);
        add_box(x + 4e-4 * column, y + 6e-4 * row, width, 3e-4, "house");
      }
    }
    add_box(x + 3e-4, y + 2e-4, 5e-4, 4e-4, "roof");  // overlaps other features
    if (next(1) < 0.5) add_round(x + 0.004, y + 0.001, 0.0015, "wood");
    if (next(1) < 0.5) add_round(x + 0.002, y + 0.004, 0.0008, "pond");
  }

  void add_box(double x, double y, double width, double height, const char* kind) {
    add(fmt::format("[{0},{1}],[{2},{1}],[{2},{3}],[{0},{3}],[{0},{1}]", x, y, x + width,
                    y + height),
        kind);
  }

  void add_round(double x, double y, double radius, const char* kind) {
    std::string ring;
    for (int i = 0; i <= 60; ++i) {
      const double angle = i % 60 * 2 * 3.14159265358979 / 60;
      const double r = radius * (1 + 0.2 * std::sin(7 * angle));
      ring += fmt::format("{}[{:.9f},{:.9f}]", i == 0 ? "" : ",", x + r * std::cos(angle),
                          y + r * std::sin(angle));
    }
    add(ring, kind);
  }

  void add(const std::string& ring, const char* kind) {
    const std::size_t id = features_.size() + 100;
    features_.push_back(
        fmt::format(R"({{"type":"Feature","id":{},"properties":{{"kind":"{}","number":{}}},)"
                    R"("geometry":{{"type":"Polygon","coordinates":[[{}]]}}}})",
                    id, kind, id % 17, ring));
  }

  std::mt19937 random_;
  std::vector<std::string> features_;
};

/// Prepares the parts as `trapeze prepare --part 1-N/N` does; returns the file name pattern of the
/// parts.
std::string prepare_parts(const TemporaryFolder& folder, const std::string& source,
                          std::uint32_t count, CoverageMode coverage, bool has_overview) {
  LoadOptions options;
  options.generalization.coverage = coverage;
  options.division = SourceDivision::of(source, {}, options.generalization, count, {});
  std::vector<std::string> files;
  const SourceStamp stamp = stamp_source(source);
  for (options.part = 1; options.part <= count; ++options.part) {
    const LoadedLayer loaded = load_layer(source, options);
    files.push_back(folder.file(fmt::format("places-{}.trapeze", options.part)));
    save_prepared_layer(files.back(), loaded, revision_of(*loaded.layer), stamp);
  }
  if (has_overview) {
    const LoadedLayer overview = overview_of(find_prepared_parts(files, {}));
    save_prepared_layer(folder.file("places-overview.trapeze"), overview,
                        revision_of(*overview.layer), stamp);
  }
  return folder.file("places-*.trapeze");
}

std::shared_ptr<const Dataset> load(const std::string& file, CoverageMode coverage) {
  auto layers = layers_of_files({file});
  layers[0].name = layers[0].title = "places";
  layers[0].coverage = coverage;
  return Dataset::load(layers);
}

/// Draws the whole layer and the layer in parts, and measures the difference.
class PartsComparison {
 public:
  PartsComparison(std::shared_ptr<const Dataset> whole, std::shared_ptr<const Dataset> parts)
      : whole_(std::move(whole)),
        parts_(std::move(parts)),
        painter_(std::make_unique<SoftwareRenderer>()) {}

  /// Visits tiles over the layer, from two zooms before the one at which the layer is about as wide
  /// as a tile to five zooms after it; a share of the tiles where there are many.
  template <typename Visit>
  void for_each_tile(const Visit& visit) const {
    const Box& box = whole_->layers()[0].layer->bounds();
    const double width = std::max<double>(static_cast<double>(box.max_x) - box.min_x, 1);
    const int first =
        std::clamp(static_cast<int>(std::log2(static_cast<double>(kGridSize) / width)), 0, 16);
    for (int zoom = std::max(first - 2, 0); zoom <= first + 5; ++zoom) {
      const std::int64_t side = TileId{zoom, 0, 0}.side();
      const auto number = [side](std::int32_t at) {
        return static_cast<std::uint32_t>((std::int64_t{at} - kGridMin) / side);
      };
      const std::uint32_t step = zoom > first + 3 ? 5 : 1;
      for (std::uint32_t y = number(box.min_y); y <= number(box.max_y - 1); y += step) {
        for (std::uint32_t x = number(box.min_x); x <= number(box.max_x - 1); x += step) {
          visit(TileId{zoom, x, y});
        }
      }
    }
  }

  /// Compares tags as well, unless overlapping features are translucent: their order affects the
  /// tag.
  void expect_equal(const std::string& query) {
    const bool is_seen_through = query.find("opacity") != std::string::npos;
    int wrong = 0;
    int tiles = 0;
    for_each_tile([&](const TileId& tile) {
      ++tiles;
      const TilePlan whole = plan(tile, query, whole_);
      const TilePlan parts = plan(tile, query, parts_);
      const PaintedTile expected = paint(whole);
      const PaintedTile drawn = paint(parts);
      const bool has_tag = is_seen_through || drawn.fingerprint == expected.fingerprint;
      const bool is_equal = has_tag && *drawn.bytes == *expected.bytes;
      if (!is_equal && ++wrong < 5) {
        ADD_FAILURE() << fmt::format("{}/{}/{}?{}: {} {}", tile.z, tile.x, tile.y, query,
                                     has_tag ? "" : "tag",
                                     *drawn.bytes == *expected.bytes ? "" : "bytes");
      }
    });
    EXPECT_EQ(wrong, 0) << "of " << tiles << " tiles";
    EXPECT_GT(tiles, 20);
  }

  struct Distance {
    double ink = 0;          // the sum of opacities of the whole layer, in whole pixels
    double missing_ink = 0;  // the sum over tiles of the difference in ink between the two
    std::size_t pixels = 0;  // pixels in which either draws something
    std::size_t far = 0;     // of these, pixels that differ by more than 16 of 255
  };
  Distance distance(const std::string& query) {
    Distance sum;
    for_each_tile([&](const TileId& tile) {
      const Picture whole = picture(plan(tile, query, whole_));
      const Picture parts = picture(plan(tile, query, parts_));
      double missing = 0;
      for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
        const int expected = whole.pixels[i].a;
        const int drawn = parts.pixels[i].a;
        sum.ink += expected / 255.0;
        missing += (expected - drawn) / 255.0;
        if (expected > 0 || drawn > 0) ++sum.pixels;
        if (std::abs(expected - drawn) > 16) ++sum.far;
      }
      sum.missing_ink += std::abs(missing);
    });
    return sum;
  }

 private:
  static TilePlan plan(const TileId& tile, const std::string& query,
                       const std::shared_ptr<const Dataset>& dataset) {
    TileRequest request;
    request.layers = {"places"};
    request.tile = tile;
    request.style = testing::style_of(query);
    return *plan_tile(request, dataset);
  }

  PaintedTile paint(const TilePlan& plan) {
    const PaintJob job{&plan};
    return painter_.paint({&job, 1}).front().value();
  }

  Picture picture(const TilePlan& plan) {
    const PaintJob job{&plan};
    return to_pixels(painter_.paint_band(job, 0).value().picture);
  }

  std::shared_ptr<const Dataset> whole_;
  std::shared_ptr<const Dataset> parts_;
  TilePainter painter_;
};

/// Styles in which whole and parts are equal in every byte: dust that is told apart by class is
/// gathered pixel by pixel over all parts, and everything else does not depend on the parts at all.
constexpr const char* kExactQueries[] = {
    "small=drop",
    "small=drop&fill-opacity=0.4&stroke=black&stroke-width=3&stroke-linejoin=miter",
    "small=drop&fill=none&stroke=black&stroke-dasharray=4,2&simplify=2",
    "small=drop&smooth=12&simplify=1&fill-opacity=0.6&stroke=black&stroke-dasharray=4,2",
    "small=drop&grow=5&fill-opacity=0.6&stroke=black&stroke-dasharray=4,2",
    "color-by=kind&classes=house:f00,pond:00f,roof:0f0,other:888",
    "filter=number%20%3C%209&fill-opacity=0.5&stroke=000",
    "small=drop&pattern=hatch&ids=107,120,333,700&highlight=120,500",
    "small=drop&fill=none&stroke=black&highlight-fill=none&highlight-stroke=red&highlight=107,500",
};

class LayerInParts : public ::testing::TestWithParam<std::uint32_t> {
 protected:
  void SetUp() override { source_ = folder_.write("villages.geojson", Villages(1).geojson()); }

  TemporaryFolder folder_;
  std::string source_;
};

TEST_P(LayerInParts, DrawsTheBytesOfTheWholeOneUnderTheSameTags) {
  for (const CoverageMode coverage : {CoverageMode::off, CoverageMode::automatic}) {
    SCOPED_TRACE(kCoverageNames.name_of(coverage));
    const TemporaryFolder folder;
    const auto parts = load(prepare_parts(folder, source_, GetParam(), coverage, false), coverage);
    ASSERT_NE(parts->layers()[0].parts, nullptr);
    PartsComparison comparison(load(source_, coverage), parts);
    for (const char* query : kExactQueries) comparison.expect_equal(query);
  }
}

TEST_P(LayerInParts, LosesNoDustWhereAPixelHasSomeOfSeveralParts) {
  const auto whole = load(source_, kUsualCoverage);
  for (const bool has_overview : {false, true}) {
    const TemporaryFolder folder;
    const auto parts = load(
        prepare_parts(folder, source_, GetParam(), kUsualCoverage, has_overview), kUsualCoverage);
    const auto distance = PartsComparison(whole, parts).distance("");
    EXPECT_GT(distance.ink, 100);
    EXPECT_LT(distance.missing_ink, 0.01 * distance.ink) << has_overview;
    EXPECT_LT(static_cast<double>(distance.far), 0.02 * static_cast<double>(distance.pixels))
        << has_overview;
  }
}

TEST_P(LayerInParts, SeedsWhatTheServerAnswersWith) {
  const TemporaryFolder folder;
  const auto parts =
      load(prepare_parts(folder, source_, GetParam(), kUsualCoverage, true), kUsualCoverage);
  for (const char* query : {"", "color-by=kind&classes=wood:080,pond:00f"}) {
    SCOPED_TRACE(query);
    SeedRequest request = testing::seed_request(*parts, {6, 11}, query);
    request.bbox = bounds_in_degrees(parts->layers()[0].layer->bounds());
    const auto plan = SeedPlan::make(request, parts);
    testing::expect_served_bytes(*plan);
  }
}

INSTANTIATE_TEST_SUITE_P(Counts, LayerInParts, ::testing::Values(1, 3, 8),
                         [](const auto& count) { return std::to_string(count.param); });

class LayerInThreeParts : public LayerInParts {
 protected:
  void SetUp() override {
    LayerInParts::SetUp();
    pattern_ = prepare_parts(folder_, source_, 3, kUsualCoverage, true);
    parts_ = load(pattern_, kUsualCoverage);
  }

  std::string body_of(const std::string& target, const std::shared_ptr<const Dataset>& dataset) {
    testing::SampleSite site(false);
    site.data().set(dataset);
    return *site.get(target).body;
  }

  std::string pattern_;
  std::shared_ptr<const Dataset> parts_;
};

TEST_F(LayerInThreeParts, LooksAtTheOverviewAloneFromAfar) {
  testing::SampleSite site(false);
  site.data().set(parts_);
  EXPECT_EQ(site.get("/tiles/places/0/0/0.png").status, 200);
  const PreparedParts& parts = *parts_->layers()[0].parts;
  EXPECT_NE(parts.overview()->layer_if_open(), nullptr);
  for (const auto& part : parts.parts()) EXPECT_EQ(part->layer_if_open(), nullptr);
  EXPECT_EQ(site.get("/tiles/places/0/0/0.png?filter=number%20%3C%209").status, 200);
  for (const auto& part : parts.parts()) EXPECT_NE(part->layer_if_open(), nullptr);
}

TEST_F(LayerInThreeParts, SaysFromTheFirstTileOnThatAPartIsDamaged) {
  const PreparedParts& parts = *parts_->layers()[0].parts;
  const std::string& path = parts.parts()[1]->path();
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path) / 2));
    file << "damage";
  }
  testing::SampleSite site(false);
  site.data().set(parts_);
  EXPECT_EQ(damage_of(parts_->layers()[0]), "") << "nobody has looked";
  for (int i = 0; i < 2; ++i) {
    const HttpResponse answer = site.get("/tiles/places/0/0/0.png?filter=number%20%3C%209");
    EXPECT_EQ(answer.status, 503);
    EXPECT_THAT(*answer.body, ::testing::HasSubstr("prepared again"));
  }
  EXPECT_THAT(damage_of(parts_->layers()[0]),
              ::testing::AllOf(::testing::StartsWith(path), ::testing::HasSubstr("is damaged")));
}

TEST_F(LayerInThreeParts, DrawsPolygonsOfTheOverviewAsThoseOfTheWhole) {
  PartsComparison comparison(load(source_, kUsualCoverage), parts_);
  comparison.expect_equal("small=drop");
  comparison.expect_equal("small=drop&stroke=black&fill-opacity=0.3&simplify=3");
}

TEST_F(LayerInThreeParts, TellsOfFeaturesAndValuesAsTheWholeDoes) {
  const auto whole = load(source_, kUsualCoverage);
  int found = 0;
  for (double lon = 14; lon < 15.5; lon += 0.011) {
    const std::string target = fmt::format("/identify/places/{:.6f},46.5", lon);
    EXPECT_EQ(body_of(target, parts_), body_of(target, whole));
  }
  const Layer& layer = *whole->layers()[0].layer;
  for (std::uint32_t row = 0; row < layer.features().size(); row += 37) {
    Rings outline;
    layer.append_outline(row, outline);
    const LonLat place = lonlat_from_grid(outline.points[0].x + 3, outline.points[0].y + 3);
    const std::string target = fmt::format("/identify/places/{:.8f},{:.8f}", place.lon, place.lat);
    const std::string answer = body_of(target, whole);
    EXPECT_EQ(body_of(target, parts_), answer);
    if (answer.find("\"kind\"") != std::string::npos) ++found;
  }
  EXPECT_GT(found, 3);
  for (const char* target : {"/values/places/kind", "/values/places/number?bbox=14,46,14.7,46.6",
                             "/values/places/kind?filter=number%20%3E%203", "/legend/places.json",
                             "/tiles/places.json"}) {
    EXPECT_EQ(body_of(target, parts_), body_of(target, whole)) << target;
  }
}

TEST_F(LayerInThreeParts, WhatWouldReadAllOfThemForATileIsRefused) {
  testing::SampleSite site(false);
  site.data().set(parts_);
  const auto refused =
      site.get("/tiles/places/3/4/2.png?color-by=number&breaks=quantile:3&ramp=YlGnBu");
  EXPECT_EQ(refused.status, 400);
  EXPECT_THAT(*refused.body, ::testing::HasSubstr("in several parts"));
  EXPECT_EQ(site.get("/tiles/places/3/4/2.png?color-by=number&breaks=3,9&ramp=YlGnBu").status, 200);
  // The legend does not claim that there are no numbers.
  const std::string legend =
      body_of("/legend/places.json?color-by=number&breaks=3,9&ramp=YlGnBu", parts_);
  EXPECT_THAT(legend, ::testing::HasSubstr("\"breaks\""));
  EXPECT_THAT(legend, ::testing::Not(::testing::HasSubstr("\"count\"")));
}

TEST_F(LayerInThreeParts, DiffersInTheTilesInWhichTheWholeDoes) {
  std::string changed_text = Villages(1).geojson();
  // One feature gets another kind.
  const std::string before = R"("kind":"pond","number":)";
  changed_text.replace(changed_text.find(before), before.size(), R"("kind":"lake","number":)");
  const TemporaryFolder folder;
  const std::string changed_source = folder.write("changed.geojson", changed_text);
  const auto now =
      load(prepare_parts(folder, changed_source, 3, kUsualCoverage, true), kUsualCoverage);
  ChangeRequest request;
  request.tile.layers = {"places"};
  request.tile.style = testing::style_of("color-by=kind&classes=lake:f00,other:000");
  request.zooms = {8, 14};
  const auto tiles = [&request](const auto& from, const auto& to) {
    return changed_tiles(request, from, to)->tiles;
  };
  const auto expected = tiles(load(source_, kUsualCoverage), load(changed_source, kUsualCoverage));
  EXPECT_GE(expected.size(), 7u);
  EXPECT_EQ(tiles(parts_, now), expected);
  EXPECT_EQ(tiles(load(source_, kUsualCoverage), now), expected) << "whole against parts";
  EXPECT_THAT(tiles(load(source_, kUsualCoverage), parts_), ::testing::IsEmpty());
}

TEST_F(LayerInThreeParts, ADamagedPartIsNotDrawnAsIfItWereEmpty) {
  const std::string file = parts_->layers()[0].parts->parts()[1]->path();
  const Box& box = parts_->layers()[0].parts->parts()[1]->summary().bounds;
  const std::int64_t side = TileId{12, 0, 0}.side();
  const std::string target = fmt::format(
      "/tiles/places/12/{}/{}.png", (box.min_x - kGridMin) / side, (box.min_y - kGridMin) / side);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  testing::SampleSite site(false);
  site.data().set(parts_);
  EXPECT_GE(site.get(target).status, 500);
  EXPECT_EQ(site.get(target).status, 503);
  EXPECT_EQ(site.get("/identify/places/14.1,46.1").status, 503);
}

TEST_F(LayerInThreeParts, IsNotServedWithoutTheTestOfTopology) {
  auto layers = layers_of_files({pattern_});
  EXPECT_EQ(layers[0].name, "places");
  layers[0].fast_topology = true;
  EXPECT_THAT([&layers] { Dataset::load(layers); },
              ::testing::ThrowsMessage<std::runtime_error>(::testing::HasSubstr("topology=fast")));
}

TEST_F(LayerInThreeParts, KeepsThePartsThatHaveNotChangedWhenItIsReadAgain) {
  const auto layers = layers_of_files({pattern_});
  const auto first = Dataset::load(layers);
  const auto again = Dataset::load(layers, first.get());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(again->layers()[0].parts->parts()[i], first->layers()[0].parts->parts()[i]);
  }
  EXPECT_EQ(again->generation(), first->generation());
}

class RealLayerInParts : public ::testing::TestWithParam<const char*> {};

TEST_P(RealLayerInParts, DrawsTheBytesOfTheWholeOneUnderTheSameTags) {
  const char* data = std::getenv("TRAPEZE_DATA");
  if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
  const std::string source = (std::filesystem::path(data) / GetParam()).string();
  const TemporaryFolder folder;
  const auto parts = load(prepare_parts(folder, source, 5, kUsualCoverage, true), kUsualCoverage);
  PartsComparison comparison(load(source, kUsualCoverage), parts);
  comparison.expect_equal("small=drop&fill-opacity=0.6&stroke=black");
  const auto distance = comparison.distance("");
  EXPECT_LT(distance.missing_ink, 0.01 * distance.ink);
  EXPECT_LT(static_cast<double>(distance.far), 0.02 * static_cast<double>(distance.pixels));
  RecordProperty("far", static_cast<int>(distance.far));
  RecordProperty("pixels", static_cast<int>(distance.pixels));
}

INSTANTIATE_TEST_SUITE_P(Files, RealLayerInParts,
                         ::testing::Values("shenzhen_buildings.fgb", "malta_natural.fgb"),
                         [](const auto& file) {
                           return std::filesystem::path(file.param).stem().string();
                         });

}  // namespace
}  // namespace trapeze
