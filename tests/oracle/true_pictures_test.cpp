// The pictures of real layers are true at every zoom and in every style.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <random>

#include "tests/oracle/held_to_truth.h"

namespace trapeze::oracle {
namespace {

constexpr int kFirstPictureZoom = 8;
constexpr int kLastPictureZoom = 18;
constexpr int kFirstDeepZoom = 14;
constexpr int kFirstZoomInDegrees = 4;

/// Layers of one place, the lowest one first.
struct Real {
  std::vector<const char*> names;
  const char* attribute = "type";  // determines the classes
};

std::string name_of(const Real& real) {
  std::string name;
  for (const char* one : real.names) name += (name.empty() ? "" : "_under_") + std::string(one);
  return name;
}

void PrintTo(const Real& real, std::ostream* out) {
  *out << name_of(real);
}

const std::vector<Real> kReal = {
    {{"malta_natural"}},
    {{"malta_landuse"}},
    {{"malta_buildings"}},
    {{"melbourne_natural"}},
    {{"melbourne_landuse"}},
    {{"shenzhen_buildings"}},
    {{"shenzhen_water"}},
    {{"europe_countries"}, "iso_a3"},
    {{"us_counties"}, "name"},
    {{"lands_complex"}, "name"},
    {{"usa48_land"}, "iso_a3"},
    {{"kobroor"}, "name"},
    {{"malta_natural", "malta_buildings"}},
    {{"malta_landuse", "malta_natural"}},
    {{"melbourne_landuse", "melbourne_natural"}},
    {{"usa48_land", "us_counties"}},
};

TileName tile_around(Place place, int zoom) {
  const double tiles = std::exp2(zoom);
  const auto number = [tiles](double share) {
    return static_cast<std::uint32_t>(std::min(std::max(share * tiles, 0.0), tiles - 1));
  };
  return {zoom, number(place.x), number(place.y)};
}

/// A position inside a feature, halfway down; none where its rings are empty.
std::optional<Place> place_inside(const TrueFeature& feature) {
  for (const TruePart& part : feature.parts) {
    const double y = (part.bounds.min_y + part.bounds.max_y) / 2;
    std::vector<double> crossings;
    for (const TrueRing& ring : part.rings) {
      for (std::size_t i = 0; i < ring.places.size(); ++i) {
        const Place a = ring.places[i];
        const Place b = ring.places[(i + 1) % ring.places.size()];
        if ((a.y <= y) != (b.y <= y)) {
          crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
        }
      }
    }
    std::ranges::sort(crossings);
    if (crossings.size() >= 2) return Place{(crossings[0] + crossings[1]) / 2, y};
  }
  return std::nullopt;
}

// The actual distances are about four fifths of these limits.
const std::vector<Exception> kExceptions = {
    // As below, and smaller scales, zooms 4 and 6, where coasts are denser.
    {"europe_countries", "degrees, classes and outline", {1.7, 0.0012}},
    {"europe_countries", "degrees, outline", {1, 0.001}},
    // Where thousands of polygons are hardly larger than lines are wide, lines that are off by a
    // quarter of a pixel lose up to half of their ink, and those of features that are narrower than
    // the tolerance are not there, or not hidden by features over them.
    {"malta_buildings", "outline", {1.5, 0.0005}},
    {"malta_landuse", "outline", {3.2, 0.004}},
    {"melbourne_natural", "outline", {2, 0.004}},
    {"shenzhen_buildings", "outline", {3.9, 0.0008}},
    {"melbourne_landuse", "outline", {7.8, 0.023}},
    // Where thousands of polygons are hardly larger than a pixel, or hardly a pixel apart, nearly
    // every pixel has edges that are up to a quarter of a pixel off, and errors of that size add
    // up.
    {"melbourne_landuse", "", {2.3, 0.0012}},
    {"shenzhen_buildings", "", {1.8, 0.0009}},
    {"malta_landuse_under_malta_natural", "", {1, 0.0007}},
    {"melbourne_landuse_under_melbourne_natural", "", {1.5, 0.0014}},
};

class RealLayers {
 public:
  RealLayers(const std::filesystem::path& folder, const Real& real, Map map = Map::mercator) {
    for (const char* name : real.names) {
      files_.push_back((folder / (std::string(name) + ".fgb")).string());
      layers_.push_back(read_layer(files_.back(), real.attribute, map));
      names_.emplace_back(name);
    }
    vertices_ = layers_.back().vertices();
  }

  const std::vector<std::string>& names() const { return names_; }
  const std::vector<std::string>& files() const { return files_; }
  const TrueLayer& upper() const { return layers_.back(); }
  std::vector<const TrueLayer*> layers() const {
    std::vector<const TrueLayer*> all;
    for (const TrueLayer& layer : layers_) all.push_back(&layer);
    return all;
  }

  /// Tiles with content: around a vertex, and inside a feature, of the upper layer; at deep zooms
  /// in turn. They are the same on every machine.
  std::vector<TileName> tiles(int zoom) {
    const std::vector<TrueFeature>& features = layers_.back().features;
    const Place vertex = vertices_[random_() % vertices_.size()];
    const std::optional<Place> inside = place_inside(features[random_() % features.size()]);
    const bool takes_both = zoom < kFirstDeepZoom;
    std::vector<TileName> tiles;
    if (takes_both || zoom % 2 == 0 || !inside) tiles.push_back(tile_around(vertex, zoom));
    if (inside && (takes_both || zoom % 2 == 1)) tiles.push_back(tile_around(*inside, zoom));
    return tiles;
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::string> files_;
  std::vector<TrueLayer> layers_;
  std::vector<Place> vertices_;
  std::mt19937 random_{1};
};

class TruePicturesTest : public ::testing::TestWithParam<Real> {
 protected:
  void SetUp() override {
    const char* data = std::getenv("TRAPEZE_DATA");
    if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
    real_.emplace(data, GetParam());
  }

  std::optional<RealLayers> real_;
};

TEST_P(TruePicturesTest, AreTrueInEveryStyleAtEveryZoom) {
  Program off(real_->files(), CoverageMode::off);
  Program automatic(real_->files(), CoverageMode::automatic);
  HeldToTruth held(
      {real_->names(), real_->layers(), {{"coverage off", &off}, {"coverage auto", &automatic}}});
  const TrueClasses classes = classes_of(real_->upper(), GetParam().attribute);
  for (int zoom = kFirstPictureZoom; zoom <= kLastPictureZoom; ++zoom) {
    for (const TileName tile : real_->tiles(zoom)) held.look_at(tile, classes);
  }
  expect_true(held, name_of(GetParam()), kExceptions);
}

INSTANTIATE_TEST_SUITE_P(Layers, TruePicturesTest, ::testing::ValuesIn(kReal),
                         [](const auto& test) { return name_of(test.param); });

class TrueInDegreesTest : public TruePicturesTest {};

TEST_P(TrueInDegreesTest, AreTrueInEveryStyleAtEveryZoom) {
  RealLayers real(std::getenv("TRAPEZE_DATA"), GetParam(), Map::degrees);
  Program automatic(real.files(), CoverageMode::automatic, Map::degrees);
  HeldToTruth held({real.names(), real.layers(), {{"degrees", &automatic}}});
  const TrueClasses classes = classes_of(real.upper(), GetParam().attribute);
  for (int zoom = kFirstZoomInDegrees; zoom <= kLastPictureZoom; zoom += 2) {
    for (const TileName tile : real.tiles(zoom)) held.look_at(tile, classes);
  }
  expect_true(held, name_of(GetParam()), kExceptions);
}

INSTANTIATE_TEST_SUITE_P(Layers, TrueInDegreesTest,
                         ::testing::Values(Real{{"europe_countries"}, "iso_a3"},
                                           Real{{"lands_complex"}, "name"}, Real{{"malta_natural"}},
                                           Real{{"usa48_land", "us_counties"}}),
                         [](const auto& test) { return name_of(test.param); });

/// Pixels with every point covered within two pixels around them.
std::vector<std::pair<int, int>> pixels_within(const TruePicture& picture) {
  constexpr int kAround = 2;
  std::vector<std::pair<int, int>> within;
  for (int row = kAround; row < kPixels - kAround; ++row) {
    for (int column = kAround; column < kPixels - kAround; ++column) {
      bool is_within = true;
      for (int y = row - kAround; y <= row + kAround; ++y) {
        for (int x = column - kAround; x <= column + kAround; ++x) {
          is_within = is_within && picture.at(x, y)[3] > 1 - 1e-9;
        }
      }
      if (is_within) within.emplace_back(column, row);
    }
  }
  return within;
}

using CoverageOfRealLayersTest = TruePicturesTest;

TEST_P(CoverageOfRealLayersTest, OneColourIsOpaqueEverywhereInside) {
  Program automatic(real_->files(), CoverageMode::automatic);
  const std::vector<StyleCase> styles = styles_of_layer({}, {});
  const std::vector<std::vector<TruePaint>> plain = {styles.front().paints};
  Workspace workspace;
  std::size_t inner = 0;
  for (int zoom = kFirstPictureZoom; zoom <= kFirstDeepZoom; ++zoom) {
    for (const TileName tile : real_->tiles(zoom)) {
      const auto truth = TrueTile(real_->layers(), tile).paint(plain, workspace);
      const Picture picture = automatic.tile(real_->names(), tile, styles.front().query);
      int least = 255;
      for (const auto& [column, row] : pixels_within(truth.front())) {
        ++inner;
        least = std::min<int>(least, picture.at(column, row).a);
      }
      EXPECT_EQ(least, 255) << text_of(tile);
    }
  }
  EXPECT_GT(inner, 100'000u) << "there was nothing to see";
}

INSTANTIATE_TEST_SUITE_P(Layers, CoverageOfRealLayersTest,
                         ::testing::Values(Real{{"us_counties"}, "name"},
                                           Real{{"europe_countries"}, "iso_a3"}),
                         [](const auto& test) { return name_of(test.param); });

}  // namespace
}  // namespace trapeze::oracle
