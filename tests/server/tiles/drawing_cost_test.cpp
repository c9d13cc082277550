#include "server/tiles/drawing_cost.h"

#include <gtest/gtest.h>

#include "server/tiles/layer_drawing.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

class DrawingCostTest : public ::testing::Test {
 protected:
  TilePlan plan(const std::string& target) const {
    const auto parsed = parse_tiles_target(split_target("/tiles/" + target).value(), StyleBook());
    return *plan_tile(std::get<TileRequest>(*parsed), dataset_);
  }
  std::uint64_t cost(const std::string& target) const { return drawing_cost(plan(target)); }

  const std::shared_ptr<const Dataset> dataset_ = testing::sample_dataset();
};

TEST_F(DrawingCostTest, IsNeverLessForMore) {
  const std::uint64_t plain = cost("rings/0/0/0.png");
  EXPECT_LT(plain, cost("rings,west/0/0/0.png"));
  EXPECT_LT(plain, cost("rings/0/0/0@2x.png"));
  EXPECT_LT(plain, cost("rings/0/0/0.png?stroke=000"));
  EXPECT_LT(cost("rings/0/0/0.png?stroke=000"), cost("rings/0/0/0.png?stroke=000&stroke-width=32"));
  EXPECT_LT(plain, cost("rings/0/0/0.png?smooth=1"));
  EXPECT_LT(plain, cost("rings/0/0/0.png?grow=1"));
  EXPECT_LT(cost("rings/0/0/0.png?grow=1"), cost("rings/0/0/0.png?grow=16"));
  EXPECT_LE(cost("rings/0/0/0.png?smooth=1"), cost("rings/0/0/0.png?smooth=64"));
  EXPECT_LE(cost("rings/4/0/0.png"), plain) << "nothing is there";
}

TEST_F(DrawingCostTest, IsThatOfTheSidesAndThePixelsOfAPlainTile) {
  const TilePlan tile = plan("rings/0/0/0.png");
  const LayerPaint& paint = tile.layers.front();
  const View view = tile.view;
  const std::uint64_t sides =
      2 * tile.layer_of(paint).estimate_trapezoids(selection_of(tile, paint, view));
  EXPECT_GT(sides, 0u);
  // A mask and a picture.
  EXPECT_EQ(drawing_cost(tile), sides + 2 * 256 * 256 / kPixelsPerSide);
}

TEST_F(DrawingCostTest, EncodingCostsSomethingForWebp) {
  EXPECT_EQ(encoding_cost(plan("rings/0/0/0@2x.png")), 0u);
  EXPECT_EQ(encoding_cost(plan("rings/0/0/0@2x.webp")), 512u * 512 * kSidesPerWebpPixel);
}

}  // namespace
}  // namespace trapeze
