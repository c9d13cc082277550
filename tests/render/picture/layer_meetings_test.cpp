#include "render/picture/layer_meetings.h"

#include <gtest/gtest.h>

#include <deque>

#include "render/picture/compose.h"
#include "render/software/software_renderer.h"
#include "tests/core/shapes/layers.h"

namespace trapeze {
namespace {

constexpr std::int32_t kPixel = 1 << 10;  // cells
constexpr int kPixels = 16;
const View kView{0, 0, kPixel, kPixels, kPixels};

constexpr Rgba kRed{255, 0, 0, 255};
constexpr Rgba kGreen{0, 255, 0, 255};
constexpr Rgba kBackground{255, 255, 255, 255};

std::int32_t cells(double pixels) {
  return static_cast<std::int32_t>(std::lround(pixels * kPixel));
}

Rings polygon(const std::vector<std::pair<double, double>>& pixels) {
  std::vector<Point> points;
  for (const auto& [x, y] : pixels) points.push_back({cells(x), cells(y)});
  Rings rings;
  rings.add(points);
  return rings;
}

/// Layers with one class each, from bottom to top.
class Map {
 public:
  void add(const std::vector<std::vector<std::pair<double, double>>>& polygons, Rgba colour,
           double tolerance = 0) {
    Drawn& drawn = layers_.emplace_back();
    drawn.tolerance = tolerance;
    for (const auto& one : polygons) {
      drawn.parts.push_back(layer_of({polygon(one)}));
      const Layer& layer = *drawn.parts.back();
      auto& ranges = drawn.ranges.emplace_back();
      layer.select({kView.box(), 0, 0, SmallPolygons::drop}, ranges);
      Mask& mask = drawn.masks.emplace_back();
      SoftwareRenderer().draw(layer.mesh(), ranges, kView, mask);
      drawn.classes.push_back({&mask, colour});
    }
  }

  Picture picture(Rgba background) {
    std::vector<PaintedLayer> painted;
    std::vector<double> tolerances;
    for (const Drawn& drawn : layers_) {
      PaintedLayer& layer = painted.emplace_back();
      layer.classes = drawn.classes;
      tolerances.push_back(drawn.tolerance);
    }
    meetings_.find(painted, tolerances, kPixels, kPixels);
    RunPicture picture;
    Composer().compose(painted, kPixels, kPixels, background, Quality::exact, picture);
    return to_pixels(picture);
  }

 private:
  struct Drawn {
    std::vector<std::unique_ptr<Layer>> parts;
    std::deque<std::vector<TrapezoidRange>> ranges;
    std::deque<Mask> masks;
    std::vector<PaintedClass> classes;
    double tolerance = 0;
  };
  std::deque<Drawn> layers_;
  LayerMeetings meetings_;
};

// A slanted border through the picture, and polygons on both sides of it.
const std::vector<std::pair<double, double>> kWest{{3.3, -1}, {11.9, 17}, {-9, 17}, {-9, -1}};
const std::vector<std::pair<double, double>> kEast{{3.3, -1}, {11.9, 17}, {30, 17}, {30, -1}};

template <typename Check>
void for_each_pixel(const Picture& picture, const Check& check) {
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      SCOPED_TRACE(::testing::Message() << "pixel " << column << ", " << row);
      check(picture.at(column, row));
    }
  }
}

TEST(LayerMeetingsTest, NothingShowsBetweenLayersThatShareABorder) {
  Map map;
  map.add({kWest}, kRed);
  map.add({kEast}, kGreen);
  for_each_pixel(map.picture(kTransparent), [](Rgba colour) {
    EXPECT_EQ(colour.a, 255);
    EXPECT_NEAR(colour.r + colour.g, 255, 1);
  });
  for_each_pixel(map.picture(kBackground), [](Rgba colour) { EXPECT_EQ(colour.b, 0); });
}

TEST(LayerMeetingsTest, ALayerOverAnEqualOneHasNoRim) {
  Map map;
  map.add({kWest}, kRed);
  map.add({kWest}, kGreen);
  Map alone;
  alone.add({kWest}, kGreen);
  const Picture both = map.picture(kBackground);
  const Picture only = alone.picture(kBackground);
  for (int row = 0; row < kPixels; ++row) {
    for (int column = 0; column < kPixels; ++column) {
      const Rgba expected = only.at(column, row);
      const Rgba actual = both.at(column, row);
      EXPECT_NEAR(actual.r, expected.r, 2) << column << ", " << row;
      EXPECT_NEAR(actual.g, expected.g, 2) << column << ", " << row;
      EXPECT_NEAR(actual.b, expected.b, 2) << column << ", " << row;
    }
  }
}

TEST(LayerMeetingsTest, ALayerWithinAnotherHidesItAlongTheirCommonEdge) {
  // The upper layer ends at the same edge as the lower one, which extends further west.
  Map map;
  map.add({kWest}, kRed);
  map.add({{{3.3, -1}, {11.9, 17}, {6, 17}, {-3, -1}}}, kGreen);
  const Picture picture = map.picture(kBackground);
  for (int row = 0; row < kPixels; ++row) {
    const double edge = 3.3 + (row + 1.5) * 8.6 / 18;
    const Rgba colour = picture.at(static_cast<int>(edge), row);
    // A mixture of green and white, without red.
    EXPECT_EQ(colour.r, colour.b) << row;
  }
}

TEST(LayerMeetingsTest, WhatLiesUnderALayerThatIsNarrowerShowsBesideIt) {
  Map map;
  map.add({{{4.25, -1}, {8.5, -1}, {8.5, 17}, {4.25, 17}}}, kRed);
  map.add({{{4.5, -1}, {8.5, -1}, {8.5, 17}, {4.5, 17}}}, kGreen);
  const Picture picture = map.picture(kTransparent);
  const Rgba beside = picture.at(4, 3);
  EXPECT_EQ(beside.a, 191);
  EXPECT_NEAR(beside.r, 85, 2);
  EXPECT_NEAR(beside.g, 170, 2);
  EXPECT_EQ(picture.at(8, 3), (Rgba{0, 255, 0, 128}));
}

TEST(LayerMeetingsTest, LayersThatCrossCoverWhatTheyCover) {
  Map map;
  map.add({{{4.5, -1}, {9.5, -1}, {9.5, 17}, {4.5, 17}}}, kRed);
  map.add({{{-1, 4.25}, {17, 4.25}, {17, 9.5}, {-1, 9.5}}}, kGreen);
  // Half of the pixel is red, three quarters are green; they share three eighths.
  const Rgba corner = map.picture(kTransparent).at(4, 4);
  EXPECT_EQ(corner.a, 223);  // 7 / 8
  EXPECT_NEAR(corner.g, 255 * 6 / 7.0, 1);
  EXPECT_NEAR(corner.r, 255 * 1 / 7.0, 1);
}

TEST(LayerMeetingsTest, AGapAsNarrowAsTheToleranceIsTheLowerLayers) {
  const std::vector<std::pair<double, double>> west{{-9, -1}, {7.2, -1}, {7.2, 17}, {-9, 17}};
  const std::vector<std::pair<double, double>> east{{7.4, -1}, {30, -1}, {30, 17}, {7.4, 17}};
  const auto picture_with = [&](double tolerance) {
    Map map;
    map.add({west}, kRed, tolerance);
    map.add({east}, kGreen, tolerance);
    return map.picture(kTransparent).at(7, 7);
  };
  EXPECT_EQ(picture_with(0).a, 204);
  const Rgba closed = picture_with(0.25);
  EXPECT_GE(closed.a, 254);
  EXPECT_NEAR(closed.g, 0.6 * 255, 2);
  EXPECT_NEAR(closed.r, 0.4 * 255, 2);
}

TEST(LayerMeetingsTest, WhatBothLeaveBesideACommonEdgeIsNoGap) {
  Map map;
  map.add({kWest}, kRed, 0.25);
  map.add({{{3.3, -1}, {11.9, 17}, {6, 17}, {-3, -1}}}, kGreen, 0.25);
  Map alone;
  alone.add({kWest}, kGreen);
  const Picture both = map.picture(kTransparent);
  const Picture only = alone.picture(kTransparent);
  for (int row = 0; row < kPixels; ++row) {
    for (int column = 0; column < kPixels; ++column) {
      EXPECT_NEAR(both.at(column, row).a, only.at(column, row).a, 2) << column << ", " << row;
    }
  }
}

TEST(LayerMeetingsTest, HalfOpaqueLayersSideBySideAreHalfOpaque) {
  Map map;
  map.add({kWest}, {255, 0, 0, 128});
  map.add({kEast}, {0, 255, 0, 128});
  for_each_pixel(map.picture(kTransparent), [](Rgba colour) { EXPECT_NEAR(colour.a, 128, 1); });
}

TEST(LayerMeetingsTest, ThreeLayersInOnePixelLeaveLittleOut) {
  Map map;
  map.add({{{-9, -9}, {7.4, -9}, {7.4, 30}, {-9, 30}}}, kRed);
  map.add({{{7.4, -9}, {30, -9}, {30, 7.6}, {7.4, 7.6}}}, kGreen);
  map.add({{{7.4, 7.6}, {30, 7.6}, {30, 30}, {7.4, 30}}}, {0, 0, 255, 255});
  const Picture picture = map.picture(kTransparent);
  for (int row = 0; row < kPixels; ++row) {
    for (int column = 0; column < kPixels; ++column) {
      const bool is_corner = row == 7 && column == 7;
      EXPECT_GE(picture.at(column, row).a, is_corner ? 230 : 254) << column << ", " << row;
    }
  }
}

TEST(LayerMeetingsTest, WhatIsAlikeAllAroundIsMixedAsChanceHasIt) {
  const Mask half(kPixels, kPixels, 100);
  const PaintedClass lower{&half, kRed};
  const PaintedClass upper{&half, kGreen};
  std::vector<PaintedLayer> layers(2);
  layers[0].classes = {&lower, 1};
  layers[1].classes = {&upper, 1};
  const std::vector<double> tolerances(2, 0.25);
  LayerMeetings meetings;
  meetings.find(layers, tolerances, kPixels, kPixels);
  EXPECT_TRUE(layers[1].meetings.empty());
  RunPicture picture;
  Composer().compose(layers, kPixels, kPixels, kTransparent, Quality::exact, picture);
  EXPECT_NEAR(picture.at(3, 3).a, 255 * (1 - 155.0 * 155 / 255 / 255), 0.51);
}

TEST(LayerMeetingsTest, WhatFillsPixelsTogetherAllAroundIsSideBySide) {
  const Mask some(kPixels, kPixels, 77);
  const Mask rest(kPixels, kPixels, 178);
  const PaintedClass lower{&some, kRed};
  const PaintedClass upper{&rest, kGreen};
  std::vector<PaintedLayer> layers(2);
  layers[0].classes = {&lower, 1};
  layers[1].classes = {&upper, 1};
  const std::vector<double> tolerances(2, 0);
  LayerMeetings meetings;
  meetings.find(layers, tolerances, kPixels, kPixels);
  RunPicture picture;
  Composer().compose(layers, kPixels, kPixels, kTransparent, Quality::exact, picture);
  EXPECT_EQ(picture.at(3, 3), (Rgba{77, 178, 0, 255}));
}

}  // namespace
}  // namespace trapeze
