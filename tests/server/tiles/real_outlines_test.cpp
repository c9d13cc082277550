// Outlines of real data are the same in all tiles.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "render/picture/png.h"
#include "server/config/load_config.h"
#include "server/data/dataset.h"
#include "tests/server/service/sample_picture.h"
#include "tests/server/service/sample_site.h"
#include "tests/server/tiles/tile_and_children.h"

namespace trapeze {
namespace {

class RealOutlinesTest : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const char* data = std::getenv("TRAPEZE_DATA");
    if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
    dataset_ =
        Dataset::load(layers_of_files({(std::filesystem::path(data) / GetParam()).string()}));
    site_.data().set(dataset_);
  }

  Picture tile(int zoom, std::uint32_t x, std::uint32_t y, const std::string& query) {
    return testing::picture_of(
        site_,
        fmt::format("/tiles/{}/{}/{}/{}{}", dataset_->layers()[0].config.name, zoom, x, y, query));
  }

  std::shared_ptr<const Dataset> dataset_;
  testing::SampleSite site_{false};
};

TEST_P(RealOutlinesTest, OfATileAtTwiceTheScaleAreThoseOfItsFourChildren) {
  const MeshView& mesh = dataset_->layers()[0].layer->mesh();
  const std::string style = ".png?fill=none&small=drop&stroke=000&stroke-width=";
  for (int zoom = 3; zoom <= 16; ++zoom) {
    SCOPED_TRACE(zoom);
    // Another place at every zoom.
    const Point place = mesh.vertices[mesh.vertices.size() / 20 * static_cast<unsigned>(zoom)];
    const std::int64_t side = TileId{zoom, 0, 0}.side();
    const auto x = static_cast<std::uint32_t>((std::int64_t{place.x} - kGridMin) / side);
    const auto y = static_cast<std::uint32_t>((std::int64_t{place.y} - kGridMin) / side);
    for (const auto& [of_parent, of_child] :
         {std::pair{"1", "2"}, std::pair{"1&stroke-dasharray=4,3", "2&stroke-dasharray=8,6"}}) {
      testing::expect_children_are_alike(tile(zoom, x, y, "@2x" + style + of_parent),
                                         {tile(zoom + 1, 2 * x, 2 * y, style + of_child),
                                          tile(zoom + 1, 2 * x + 1, 2 * y, style + of_child),
                                          tile(zoom + 1, 2 * x, 2 * y + 1, style + of_child),
                                          tile(zoom + 1, 2 * x + 1, 2 * y + 1, style + of_child)});
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Files, RealOutlinesTest,
                         ::testing::Values("malta_landuse.fgb", "lands_complex.fgb",
                                           "us_counties.fgb"),
                         [](const auto& file) {
                           std::string name = file.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace trapeze
