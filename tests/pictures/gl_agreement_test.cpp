// GL draws real layers like the software renderer.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "render/software/software_renderer.h"
#include "tests/pictures/real_layers.h"
#include "tests/pictures/shared_gl.h"
#include "tests/render/compare_renderers.h"

namespace trapeze::testing {
namespace {

constexpr int kLastGlZoom = 22;
constexpr int kGlTilesPerZoom = 4;

class GlAgreementTest : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    real_ = real_layer(GetParam());
    if (real_ == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of .fgb files";
    gl_ = shared_gl().renderer.get();
    if (gl_ == nullptr) GTEST_SKIP() << "there is no GL here: " << shared_gl().reasons;
  }
  void TearDown() override {
    if (gl_ != nullptr) gl_->forget(real_->layer->mesh().id);
  }

  Difference compare(const TileId& tile, const Layer::Selection& selection) {
    real_->layer->select(selection, ranges_);
    real_->layer->keep_uppermost(ranges_);
    return compare_renderers(software_, *gl_, real_->layer->mesh(), ranges_, View::of_tile(tile));
  }

  const RealLayer* real_ = nullptr;
  MaskRenderer* gl_ = nullptr;
  SoftwareRenderer software_;
  std::vector<TrapezoidRange> ranges_;
};

TEST_P(GlAgreementTest, EveryTileIsThatOfTheSoftwareRenderer) {
  int worst = 0;
  std::size_t above_1 = 0;
  int pictures = 0;
  for (int zoom = 0; zoom <= kLastGlZoom; ++zoom) {
    for (const TileId& tile : tiles_around_vertices(*real_, zoom, kGlTilesPerZoom, 1)) {
      Layer::Selection selection = default_selection(View::of_tile(tile));
      for (const Level level : {selection.level, Level{0}}) {
        selection.level = level;
        const Difference difference = compare(tile, selection);
        EXPECT_TRUE(difference.is_within_bounds())
            << text_of(tile) << " at level " << +level << ": " << difference;
        worst = std::max(worst, difference.worst);
        above_1 += difference.above_1;
        ++pictures;
      }
    }
  }
  std::cout << GetParam() << ": " << pictures << " pictures by " << gl_->description()
            << ", worst difference " << worst << ", " << above_1 << " pixels above 1\n";
}

INSTANTIATE_TEST_SUITE_P(Layers, GlAgreementTest, ::testing::ValuesIn(real_layer_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace trapeze::testing
