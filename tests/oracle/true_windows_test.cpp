// Windows of any place and scale are true in seven systems: Web Mercator, degrees, the grids of
// Switzerland, Britain, the Netherlands and Europe, and a polar one.
//
// A few windows of each system are tested, or as many in all as the variable TRAPEZE_ORACLE_WINDOWS
// specifies, for example 10000.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>

#include <gdal_priv.h>

#include <gdal_utils.h>

#include "tests/core/io/temporary_folder.h"
#include "tests/oracle/compare.h"
#include "tests/oracle/held_to_truth.h"
#include "tests/oracle/program.h"
#include "tests/oracle/style_cases.h"

namespace trapeze::oracle {
namespace {

constexpr int kUsualWindows = 5;  // of each grid
constexpr double kInside = 2;     // pixels away from all edges
constexpr double kHalfOfMercator = 20037508.342789244;

/// A reference system, and a layer in it.
struct Grid {
  Plane plane;
  Bounds wanted;  // in units of the plane: windows are around vertices in that
  const char* layer;
  const char* where;  // selects its features, in SQL; all if it is empty
  const char* attribute;
  double finest = 1;  // units per pixel
  double coarsest = 1;
  bool has_outlines = true;
};

constexpr double kFar = 1e9;
const Bounds kEverywhere{-kFar, -kFar, kFar, kFar};

const std::vector<Grid> kGrids = {
    {{"EPSG:3857", -kHalfOfMercator, kHalfOfMercator, 2 * kHalfOfMercator},
     kEverywhere,
     "malta_natural",
     "",
     "type",
     0.5,
     80},
    {{"EPSG:2056", 2'000'000, 1'600'000, 1'000'000, {4, 44, 12.5, 49}, 0.002},
     {2'480'000, 1'070'000, 2'840'000, 1'300'000},
     "europe_countries",
     "iso_a3 IN ('CHE', 'LIE', 'AUT')",
     "iso_a3",
     1,
     600},
    {{"EPSG:3035", 0, 8'000'000, 8'000'000, {13, 35, 16, 37}, 0.002},
     kEverywhere,
     "malta_natural",
     "",
     "type",
     0.5,
     80},
    {{"EPSG:4326", -180, 180, 360}, kEverywhere, "malta_natural", "", "type", 0.000005, 0.001},
    {{"EPSG:27700", -1'000'000, 2'000'000, 3'000'000, {-12, 49, 4, 62}, 0.002},
     kEverywhere,
     "lands_complex",
     "name = 'Great Britain'",
     "name",
     5,
     600},
    {{"EPSG:28992", -500'000, 1'200'000, 2'000'000, {2, 50, 8, 54}, 0.002},
     kEverywhere,
     "europe_countries",
     "iso_a3 = 'NLD'",
     "iso_a3",
     1,
     200},
    // The oracle would draw an outline along the antimeridian, as it knows edges and not seams.
    {{"EPSG:5042", -4'000'000, 8'000'000, 12'000'000, {-180, -90, 180, -60}, 0.02},
     {-1'000'000, -1'000'000, 5'000'000, 5'000'000},
     "lands_complex",
     "name = 'Antarctica'",
     "name",
     20,
     2000,
     false},
};

void PrintTo(const Grid& grid, std::ostream* out) {
  *out << grid.plane.name;
}

bool is_map(const Grid& grid) {
  return grid.plane.name == "EPSG:3857" || grid.plane.name == "EPSG:4326";
}

int windows_of_each() {
  const char* all = std::getenv("TRAPEZE_ORACLE_WINDOWS");
  return all == nullptr ? kUsualWindows
                        : std::max(std::atoi(all) / static_cast<int>(kGrids.size()), 1);
}

TrueLayer read(const Grid& grid, const std::string& file) {
  if (grid.plane.name == "EPSG:3857") return read_layer(file, grid.attribute, Map::mercator);
  if (grid.plane.name == "EPSG:4326") return read_layer(file, grid.attribute, Map::degrees);
  return read_layer_on(grid.plane, file, grid.attribute);
}

/// Copies some features of a source to a new one.
std::string copy_of(const std::string& source, const char* where, const std::string& path) {
  const GDALDatasetUniquePtr from(
      GDALDataset::Open(source.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
  if (from == nullptr) throw std::runtime_error("GDAL cannot open " + source);
  std::vector<std::string> words = {"-f", "FlatGeobuf", "-where", where};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  GDALVectorTranslateOptions* options = GDALVectorTranslateOptionsNew(arguments.data(), nullptr);
  GDALDatasetH in = GDALDataset::ToHandle(from.get());
  GDALDatasetH out = GDALVectorTranslate(path.c_str(), nullptr, 1, &in, options, nullptr);
  GDALVectorTranslateOptionsFree(options);
  if (out == nullptr) throw std::runtime_error("GDAL cannot write " + path);
  GDALClose(out);
  return path;
}

class TrueWindowsTest : public ::testing::TestWithParam<Grid> {
 protected:
  void SetUp() override {
    const char* data = std::getenv("TRAPEZE_DATA");
    if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
    const Grid& grid = GetParam();
    GDALAllRegister();
    name_ = grid.layer;
    std::string file = (std::filesystem::path(data) / (name_ + ".fgb")).string();
    if (*grid.where != '\0') file = copy_of(file, grid.where, folder_.file(name_ + ".fgb"));
    layer_ = read(grid, file);
    const std::vector<std::string> files = {file};
    program_ = is_map(grid) ? std::make_unique<Program>(files, CoverageMode::automatic)
                            : std::make_unique<Program>(files, grid.plane.name);
    for (const Place place : layer_.vertices()) {
      if (is_wanted(place)) vertices_.push_back(place);
    }
    ASSERT_FALSE(vertices_.empty());
  }

  bool is_wanted(Place place) const {
    const Plane& plane = GetParam().plane;
    const double x = plane.west + place.x * plane.side;
    const double y = plane.north - place.y * plane.side;
    return GetParam().wanted.meets({x, y, x, y});
  }

  double random(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  /// Around a random vertex, at a scale from a log-uniform distribution.
  Window random_window() {
    const Grid& grid = GetParam();
    const double pixel = std::exp(random(std::log(grid.finest), std::log(grid.coarsest)));
    const double side = pixel * kPixels / grid.plane.side;
    const Place vertex = vertices_[random_() % vertices_.size()];
    return {{vertex.x - random(0.2, 0.8) * side, vertex.y - random(0.2, 0.8) * side}, side};
  }

  std::string target_of(const Window& window) const {
    const Plane& plane = GetParam().plane;
    const double west = plane.west + window.corner.x * plane.side;
    const double north = plane.north - window.corner.y * plane.side;
    const double side = window.side * plane.side;
    return fmt::format("{}.png?crs={}&bbox={:.17g},{:.17g},{:.17g},{:.17g}&width={}&height={}",
                       name_, plane.name, west, north - side, west + side, north, kPixels, kPixels);
  }

  TemporaryFolder folder_;
  std::string name_;
  TrueLayer layer_;
  std::unique_ptr<Program> program_;
  std::vector<Place> vertices_;
  std::mt19937 random_{20};
};

TEST_P(TrueWindowsTest, AreTrueAtAnyPlaceAndScale) {
  const Grid& grid = GetParam();
  std::vector<StyleCase> styles = styles_of_layer(classes_of(layer_, grid.attribute), {});
  if (!grid.has_outlines) {
    std::erase_if(styles, [](const StyleCase& style) { return style.line_width > 0; });
  }
  const std::vector<const TrueLayer*> layers = {&layer_};
  Workspace workspace;
  std::map<std::string, Distance> distances;
  const int windows = windows_of_each();
  for (int i = 0; i < windows; ++i) {
    const Window window = random_window();
    const StyleCase& style = styles[static_cast<std::size_t>(i) % styles.size()];
    const TrueTile truth(layers, window);
    const std::vector<std::vector<TruePaint>> paints = {style.paints};
    const std::vector<TruePicture> pictures = truth.paint(paints, workspace);
    const std::vector<bool> near = truth.near_edges(kInside + style.line_width / 2);
    const std::string target = target_of(window);
    const Picture picture = program_->map(target, style.query);
    distances[style.line_width > 0 ? "outlines" : "fills"].add(
        compare(picture, {pictures.data(), &near, style.is_opaque, target + "&" + style.query}));
  }
  for (const auto& [kind, distance] : distances) {
    std::printf(
        "%s: %s of %zu windows: mean %.3f/255, over 64 %.4f %%, inner %zu of %zu, worst %.0f in "
        "%s\n",
        grid.plane.name.c_str(), kind.c_str(), distance.pixels / (kPixels * kPixels),
        distance.mean(), 100 * distance.share(), distance.inner_different, distance.inner,
        distance.worst, distance.worst_place.c_str());
    const Limits limits = kind == "outlines" ? Limits{1, 0.002} : Limits{};
    EXPECT_LE(distance.mean(), limits.mean);
    EXPECT_LE(distance.share(), limits.share) << distance.worst_place;
    EXPECT_EQ(distance.inner_different, 0u) << distance.first_inner_place;
  }
}

INSTANTIATE_TEST_SUITE_P(Grids, TrueWindowsTest, ::testing::ValuesIn(kGrids),
                         [](const auto& test) { return test.param.plane.name.substr(5); });

}  // namespace
}  // namespace trapeze::oracle
