// Prepared layers are served as if they had been built from their source.
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/io/prepared/prepared_layer.h"
#include "render/make_renderer.h"
#include "server/config/load_config.h"
#include "server/data/dataset.h"
#include "server/tiles/tile_painter.h"
#include "server/tiles/tile_plan.h"
#include "server/tiles/tile_request.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using testing::fixture;

/// Prepares as `trapeze prepare` does; returns the path of the prepared file.
std::string prepare(const TemporaryFolder& folder, const std::string& source) {
  const std::string path = folder.file(std::filesystem::path(source).stem().string() + ".trapeze");
  const LoadedLayer loaded = load_layer(source);
  save_prepared_layer(path, loaded, revision_of(*loaded.layer), stamp_source(source));
  return path;
}

std::shared_ptr<const Dataset> load(const std::string& file) {
  auto layers = layers_of_files({file});
  layers[0].fast_topology = true;
  return Dataset::load(layers);
}

/// Paints the tiles of both datasets and compares pictures and entity tags.
class PreparedComparison {
 public:
  PreparedComparison(std::shared_ptr<const Dataset> built, std::shared_ptr<const Dataset> prepared)
      : built_(std::move(built)),
        prepared_(std::move(prepared)),
        painter_(std::move(make_renderers({RendererKind::software, {}}, 1).renderers.front())) {}

  void expect_equal(const TileId& tile, const std::string& query) {
    const std::string target =
        fmt::format("/tiles/{}/{}/{}/{}.png?{}", built_->layers()[0].config.name, tile.z, tile.x,
                    tile.y, query);
    const auto parsed = parse_tiles_target(split_target(target).value(), StyleBook());
    const auto& request = std::get<TileRequest>(*parsed);
    const TilePlan built = *plan_tile(request, built_);
    const TilePlan prepared = *plan_tile(request, prepared_);
    EXPECT_EQ(prepared.key(), built.key()) << "the entity tag is a hash of it: " << target;
    EXPECT_EQ(*paint(prepared).bytes, *paint(built).bytes) << target;
  }

  /// A tile at every zoom, over the middle of a polygon.
  void expect_equal_at_all_zooms(const std::string& query) {
    const MeshView& mesh = built_->layers()[0].layer->mesh();
    const Point place = mesh.vertices[mesh.vertices.size() / 2];
    for (int zoom = 0; zoom <= 18; ++zoom) {
      const std::int64_t side = TileId{zoom, 0, 0}.side();
      const auto number = [side, zoom](std::int32_t at) {
        const std::int64_t last = (std::int64_t{1} << zoom) - 1;
        return static_cast<std::uint32_t>(std::min((std::int64_t{at} - kGridMin) / side, last));
      };
      expect_equal({zoom, number(place.x), number(place.y)}, query);
    }
  }

 private:
  PaintedTile paint(const TilePlan& plan) {
    const PaintJob job{&plan};
    return painter_.paint({&job, 1}).front().value();
  }

  const std::shared_ptr<const Dataset> built_;
  const std::shared_ptr<const Dataset> prepared_;
  TilePainter painter_;
};

constexpr const char* kQueries[] = {"", "small=keep&simplify=2", "topology=fast&simplify=4",
                                    "small=drop&debug=mesh,vertices",
                                    "stroke=000&stroke-dasharray=4,2"};

TEST(PreparedDatasetTest, DrawsTheBytesOfTheBuiltOneUnderTheSameTags) {
  const TemporaryFolder folder;
  for (const char* name : {"rings.geojson", "mixed.geojson", "village.osm", "speck.geojson"}) {
    const auto built = load(fixture(name));
    const auto prepared = load(prepare(folder, fixture(name)));
    EXPECT_EQ(prepared->generation(), built->generation());
    PreparedComparison comparison(built, prepared);
    for (const char* query : kQueries) comparison.expect_equal_at_all_zooms(query);
  }
}

TEST(PreparedDatasetTest, TakesTheConfiguredWeightsOrRefuses) {
  const TemporaryFolder folder;
  auto layers = layers_of_files({prepare(folder, fixture("rings.geojson"))});
  layers[0].weights = WeightRule::effective_area;
  EXPECT_THAT([&layers] { Dataset::load(layers); },
              ::testing::ThrowsMessage<std::runtime_error>(::testing::HasSubstr("effective-area")));
  layers[0].weights = WeightRule::douglas_peucker;
  EXPECT_NO_THROW(Dataset::load(layers));
}

TEST(PreparedDatasetTest, ServesThePreparedFileOfALayerAndComparesItWithItsFile) {
  const TemporaryFolder folder;
  auto layers = layers_of_files({fixture("rings.geojson")});
  layers[0].prepared = prepare(folder, fixture("rings.geojson"));
  EXPECT_EQ(Dataset::load(layers)->layers()[0].report.path, layers[0].prepared);
  layers[0].file = fixture("west.geojson");
  EXPECT_THAT([&layers] { Dataset::load(layers); },
              ::testing::ThrowsMessage<std::runtime_error>(::testing::HasSubstr("west.geojson")));
}

TEST(PreparedDatasetTest, ADamagedLayerIsNotAnsweredFromWhatIsKeptEither) {
  const TemporaryFolder folder;
  const std::string file = prepare(folder, fixture("rings.geojson"));
  testing::SampleSite site(false);
  site.data().set(load(file));
  const std::string target = "/tiles/rings/0/0/0.png";
  const auto drawn = site.get(target);
  ASSERT_EQ(drawn.status, 200);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_EQ(site.get(target).status, 503);
  EXPECT_EQ(site.get(target, std::string(drawn.header("ETag"))).status, 503);
}

class RealPreparedDatasetTest : public ::testing::TestWithParam<const char*> {};

TEST_P(RealPreparedDatasetTest, DrawsTheBytesOfTheBuiltOneUnderTheSameTags) {
  const char* data = std::getenv("TRAPEZE_DATA");
  if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
  const std::string file = (std::filesystem::path(data) / GetParam()).string();
  const TemporaryFolder folder;
  const auto built = load(file);
  const auto prepared = load(prepare(folder, file));
  EXPECT_EQ(prepared->generation(), built->generation());
  PreparedComparison comparison(built, prepared);
  for (const char* query : kQueries) comparison.expect_equal_at_all_zooms(query);
}

INSTANTIATE_TEST_SUITE_P(Files, RealPreparedDatasetTest,
                         ::testing::Values("malta_buildings.fgb", "shenzhen_buildings.fgb",
                                           "lands_complex.fgb", "us_counties.fgb"),
                         [](const auto& file) {
                           return std::filesystem::path(file.param).stem().string();
                         });

}  // namespace
}  // namespace trapeze
