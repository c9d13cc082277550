// Adjacent tiles form one picture: no seam shows where they meet.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "render/software/software_renderer.h"
#include "tests/pictures/real_layers.h"
#include "tests/pictures/shared_gl.h"
#include "tests/render/compare_renderers.h"
#include "tests/render/masks.h"

namespace trapeze::testing {
namespace {

constexpr std::array kZooms = {0, 3, 6, 9, 11, 13, 15, 17, 19, 21};
constexpr int kPlacesPerZoom = 6;

void draw(const RealLayer& real, const View& view, MaskRenderer& renderer, Mask& out) {
  std::vector<TrapezoidRange> ranges;
  real.layer->select(default_selection(view), ranges);
  real.layer->keep_uppermost(ranges);
  renderer.draw(real.layer->mesh(), ranges, view, out);
}

/// The four tiles of the next zoom that make up `tile`, joined in one mask.
Mask put_together(const RealLayer& real, const TileId& tile, MaskRenderer& renderer) {
  std::array<std::vector<std::uint8_t>, 4> quarters;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const TileId child{tile.z + 1, 2 * tile.x + i % 2, 2 * tile.y + i / 2};
    Mask quarter;
    draw(real, View::of_tile(child), renderer, quarter);
    quarters[i] = values_of(quarter);
  }
  return mask_by(2 * kTilePixels, 2 * kTilePixels, [&quarters](int column, int row) {
    const int quarter = row / kTilePixels * 2 + column / kTilePixels;
    const int pixel = row % kTilePixels * kTilePixels + column % kTilePixels;
    return quarters[static_cast<std::size_t>(quarter)][static_cast<std::size_t>(pixel)];
  });
}

void expect_no_seams(const RealLayer& real, MaskRenderer& renderer) {
  for (const int zoom : kZooms) {
    for (const TileId& tile : tiles_around_vertices(real, zoom, kPlacesPerZoom, 2)) {
      Mask whole;
      draw(real, View::of_tile(tile, 2), renderer, whole);
      const Difference difference = compare_masks(whole, put_together(real, tile, renderer));
      EXPECT_LE(difference.worst, 1) << text_of(tile) << ": " << difference;
    }
  }
}

class NeighbouringTilesTest : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    real_ = real_layer(GetParam());
    if (real_ == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of .fgb files";
  }

  const RealLayer* real_ = nullptr;
};

TEST_P(NeighbouringTilesTest, AreOnePictureInSoftware) {
  SoftwareRenderer software;
  expect_no_seams(*real_, software);
}

using GlNeighbouringTilesTest = NeighbouringTilesTest;

TEST_P(GlNeighbouringTilesTest, AreOnePicture) {
  MaskRenderer* gl = shared_gl().renderer.get();
  if (gl == nullptr) GTEST_SKIP() << "there is no GL here: " << shared_gl().reasons;
  expect_no_seams(*real_, *gl);
  gl->forget(real_->layer->mesh().id);
}

INSTANTIATE_TEST_SUITE_P(Layers, NeighbouringTilesTest, ::testing::ValuesIn(real_layer_names()),
                         [](const auto& test) { return test.param; });
INSTANTIATE_TEST_SUITE_P(Layers, GlNeighbouringTilesTest, ::testing::ValuesIn(real_layer_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace trapeze::testing
