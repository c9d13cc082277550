#include "render/picture/compose.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <random>
#include <set>
#include <stdexcept>
#include <vector>

#include "tests/render/masks.h"

namespace trapeze {
namespace {

RunPicture composed(std::span<const PaintedClass> layers, int width, int height,
                    Rgba background = kTransparent) {
  RunPicture picture;
  Composer().compose(plain_layers(layers), width, height, background, Quality::exact, picture);
  return picture;
}

Picture compose(std::span<const PaintedClass> layers, int width, int height,
                Rgba background = kTransparent) {
  return to_pixels(composed(layers, width, height, background));
}

Mask mask_of(int width, int height, const std::vector<int>& values) {
  return testing::mask_by(width, height, [&](int column, int row) {
    return values[static_cast<std::size_t>(row * width + column)];
  });
}

Mask random_mask(std::mt19937& random, int width, int height) {
  std::vector<int> values(static_cast<std::size_t>(width * height));
  for (int& value : values) value = static_cast<int>(random() % 256);
  return mask_of(width, height, values);
}

// One pixel of "source over", computed in double directly from its definition.
struct Channels {
  double r, g, b, a;
};
Channels blend(const Channels& below, Rgba fill, int value) {
  const double a = fill.a / 255.0 * value / 255.0;
  const double sum = a + below.a * (1 - a);
  const auto mix = [&](double above, double under) {
    return sum == 0 ? 0 : (above * a + under * below.a * (1 - a)) / sum;
  };
  return {mix(fill.r, below.r), mix(fill.g, below.g), mix(fill.b, below.b), sum};
}

// The colour of a nearly transparent pixel is rounded like any other, but divided by its opacity.
void expect_near(Rgba actual, const Channels& expected) {
  EXPECT_NEAR(actual.a, expected.a * 255, 0.51);
  if (actual.a == 0) return;
  EXPECT_NEAR(actual.r, expected.r, 0.51);
  EXPECT_NEAR(actual.g, expected.g, 0.51);
  EXPECT_NEAR(actual.b, expected.b, 0.51);
}

TEST(ComposeTest, OneColourOverNothingHasTheValuesOfItsMaskAsOpacities) {
  const Mask mask = mask_of(3, 1, {0, 100, 255});
  const PaintedClass layer{&mask, {10, 20, 30, 255}};
  const Picture picture = compose({&layer, 1}, 3, 1);
  EXPECT_EQ(picture.at(0, 0), kTransparent);
  EXPECT_EQ(picture.at(1, 0), (Rgba{10, 20, 30, 100}));
  EXPECT_EQ(picture.at(2, 0), (Rgba{10, 20, 30, 255}));
}

TEST(ComposeTest, OneColourOverAnOpaqueBackgroundIsOpaque) {
  const Mask mask = mask_of(3, 1, {0, 51, 255});
  const PaintedClass layer{&mask, {255, 0, 0, 255}};
  const Picture picture = compose({&layer, 1}, 3, 1, {0, 0, 255, 255});
  EXPECT_EQ(picture.at(0, 0), (Rgba{0, 0, 255, 255}));
  EXPECT_EQ(picture.at(1, 0), (Rgba{51, 0, 204, 255}));
  EXPECT_EQ(picture.at(2, 0), (Rgba{255, 0, 0, 255}));
}

TEST(ComposeTest, LayersThatDoNotShowCostNothing) {
  const Mask empty = mask_of(2, 1, {0, 0});
  const Mask full = mask_of(2, 1, {255, 128});
  const std::vector<PaintedClass> layers{
      {&empty, {1, 1, 1, 255}}, {&full, {9, 9, 9, 0}}, {&full, {4, 5, 6, 255}}};
  const Picture picture = compose(layers, 2, 1);
  EXPECT_EQ(picture.at(0, 0), (Rgba{4, 5, 6, 255}));
}

TEST(ComposeTest, NoLayerIsTheBackground) {
  const RunPicture picture = composed({}, 2, 2, {1, 2, 3, 4});
  EXPECT_EQ(picture.colours.size(), 1u);
  EXPECT_EQ(picture.runs.size(), 2u);
  EXPECT_EQ(picture.at(1, 1), (Rgba{1, 2, 3, 4}));
}

TEST(ComposeTest, EveryLayerLiesOverTheOnesBefore) {
  const Mask full = mask_of(1, 1, {255});
  const std::vector<PaintedClass> layers{{&full, {255, 0, 0, 255}}, {&full, {0, 255, 0, 255}}};
  EXPECT_EQ(compose(layers, 1, 1).at(0, 0), (Rgba{0, 255, 0, 255}));
}

TEST(ComposeTest, IsSourceOverToTheLastDigit) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const Rgba background : {kTransparent, Rgba{200, 210, 220, 255}, Rgba{9, 99, 200, 77}}) {
    const Mask a = random_mask(random, 40, 30);
    const Mask b = random_mask(random, 40, 30);
    const Mask c = random_mask(random, 40, 30);
    const std::vector<PaintedClass> layers{
        {&a, {250, 3, 90, 255}}, {&b, {0, 128, 255, 140}}, {&c, {77, 200, 10, 30}}};
    const Picture picture = compose(layers, 40, 30, background);
    for (int row = 0; row < 30; ++row) {
      for (int column = 0; column < 40; ++column) {
        Channels expected{double(background.r), double(background.g), double(background.b),
                          background.a / 255.0};
        for (const PaintedClass& layer : layers) {
          expected = blend(expected, layer.colour, layer.mask->at(column, row));
        }
        expect_near(picture.at(column, row), expected);
      }
    }
  }
}

// If a layer has several classes, all layers are mixed pixel by pixel, even where the layer is
// invisible; without such a layer, several mixtures are computed at the same time.
TEST(ComposeTest, ColoursAreTheSameOneByOneAndSeveralAtOnce) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const Rgba background : {kTransparent, Rgba{200, 210, 220, 255}, Rgba{9, 99, 200, 77}}) {
    const Mask nothing(33, 9);
    const std::vector<PaintedClass> none{{&nothing, {1, 2, 3, 255}}, {&nothing, {4, 5, 6, 255}}};
    std::vector<Mask> masks;
    for (int i = 0; i < 5; ++i) masks.push_back(random_mask(random, 33, 9));
    const PaintedClass fills[] = {{&masks[0], {250, 3, 90, 255}}, {&masks[1], {0, 128, 255, 140}}};
    const PaintedClass lines[] = {
        {&masks[2], {0, 0, 0, 255}}, {&masks[3], {9, 255, 8, 0}}, {&masks[4], {80, 70, 0, 3}}};
    std::vector<PaintedLayer> layers{{.classes = {&fills[0], 1}, .lines = lines},
                                     {.classes = {&fills[1], 1}, .opacity = 0.3}};
    RunPicture at_once;
    Composer().compose(layers, 33, 9, background, Quality::exact, at_once);
    layers.push_back({.classes = none});
    RunPicture one_by_one;
    Composer().compose(layers, 33, 9, background, Quality::exact, one_by_one);
    EXPECT_EQ(to_pixels(at_once).pixels, to_pixels(one_by_one).pixels);
  }
}

TEST(ComposeTest, RunsEndWhereColoursChange) {
  std::vector<int> left(64 * 64), right(64 * 64);
  for (std::size_t i = 0; i < left.size(); ++i) {
    left[i] = i % 64 < 30 ? 255 : 40;
    right[i] = i % 64 > 32 ? 255 : 0;
  }
  const Mask a = mask_of(64, 64, left);
  const Mask b = mask_of(64, 64, right);
  const std::vector<PaintedClass> layers{{&a, {255, 0, 0, 255}}, {&b, {0, 0, 255, 255}}};
  const RunPicture picture = composed(layers, 64, 64);
  EXPECT_EQ(picture.runs.size(), 3u * 64);
  for (int row = 0; row < 64; ++row) {
    const auto runs = picture.row(row);
    ASSERT_EQ(runs.size(), 3u);
    EXPECT_EQ(runs[0].end, 30u);
    EXPECT_EQ(runs[1].end, 33u);
    EXPECT_EQ(runs[2].end, 64u);
  }
  EXPECT_EQ(picture.at(0, 5), (Rgba{255, 0, 0, 255}));
  EXPECT_EQ(picture.at(31, 5), (Rgba{255, 0, 0, 40}));
  EXPECT_EQ(picture.at(60, 5), (Rgba{0, 0, 255, 255}));
}

Picture compose(const PaintedLayer& layer, int width, int height, Rgba background = kTransparent) {
  RunPicture picture;
  Composer().compose({&layer, 1}, width, height, background, Quality::exact, picture);
  return to_pixels(picture);
}

TEST(ComposeTest, ClassesOfOneLayerLeaveNoLineBetweenThem) {
  const Mask west = mask_of(4, 1, {255, 100, 64, 1});
  const Mask east = mask_of(4, 1, {0, 155, 64, 254});
  const Mask rest = mask_of(4, 1, {0, 0, 126, 0});  // a third class, rounded down
  const std::vector<PaintedClass> alike{
      {&west, {9, 8, 7, 255}}, {&east, {9, 8, 7, 255}}, {&rest, {9, 8, 7, 255}}};
  const Picture one = compose({.classes = alike}, 4, 1);
  for (int column = 0; column < 4; ++column) {
    EXPECT_EQ(one.at(column, 0), (Rgba{9, 8, 7, 255})) << column;
  }
  const std::vector<PaintedClass> unlike{{&west, {255, 0, 0, 255}}, {&east, {0, 0, 255, 255}}};
  const Picture two = compose({.classes = unlike}, 4, 1);
  EXPECT_EQ(two.at(1, 0), (Rgba{100, 0, 155, 255}));
}

TEST(ComposeTest, OverlappingClassesShareThePixel) {
  const Mask full = mask_of(1, 1, {255});
  const std::vector<PaintedClass> classes{{&full, {200, 0, 0, 255}}, {nullptr, {0, 0, 100, 255}}};
  EXPECT_EQ(compose({.classes = classes}, 1, 1).at(0, 0), (Rgba{100, 0, 50, 255}));
}

TEST(ComposeTest, APatternLiesWithinTheClasses) {
  constexpr std::size_t kColumns = 24;
  View view;
  view.width = static_cast<int>(kColumns);
  view.height = 1;
  PlacedPattern stripes;
  stripes.place({PatternKind::stripes, {}, 8, 80, 4}, view, 1);
  std::array<std::uint8_t, kColumns> values{};
  stripes.draw(0, 0, kColumns, values.data());
  ASSERT_THAT(values, ::testing::AllOf(::testing::Contains(0), ::testing::Contains(255)));
  const Mask covered = testing::mask_by(view.width, 1, [](int column, int) {
    return column < 8 ? 0 : column < 16 ? 51 : 255;
  });
  const PaintedClass fill{&covered, {0, 0, 0, 255}};
  const PaintedClass nothing{&covered, kTransparent};
  PaintedLayer layer{{&fill, 1}, &stripes, {255, 255, 255, 255}, {}, 1};
  const Picture over_fill = compose(layer, view.width, 1);
  layer.classes = {&nothing, 1};
  const Picture alone = compose(layer, view.width, 1);
  for (int column = 0; column < view.width; ++column) {
    const std::uint8_t share = values[static_cast<std::size_t>(column)];
    const std::uint8_t alpha = covered.at(column, 0);
    const Rgba expected{share, share, share, alpha};
    EXPECT_EQ(over_fill.at(column, 0), alpha == 0 ? kTransparent : expected) << column;
    EXPECT_NEAR(alone.at(column, 0).a, alpha * share / 255.0, 0.51) << column;
  }
}

TEST(ComposeTest, OpacityIsOfTheLayerAsAWhole) {
  const Mask fill = mask_of(16, 1, std::vector<int>(16, 255));
  const Mask line = mask_of(16, 1,
                            {255, 255, 255, 255, 255, 255, 255, 255,  //
                             0, 0, 0, 0, 0, 0, 0, 255});
  const PaintedClass fills{&fill, {0, 0, 200, 255}};
  const PaintedClass lines{&line, {100, 0, 0, 255}};
  const PaintedLayer layer{{&fills, 1}, nullptr, {}, {&lines, 1}, 0.5};
  const Picture picture = compose(layer, 16, 1, {0, 0, 0, 255});
  EXPECT_EQ(picture.at(3, 0), (Rgba{50, 0, 0, 255}));  // none of the fill shows through
  EXPECT_EQ(picture.at(9, 0), (Rgba{0, 0, 100, 255}));
  EXPECT_EQ(picture.at(15, 0), (Rgba{50, 0, 0, 255}));
  EXPECT_EQ(compose(layer, 16, 1).at(3, 0), (Rgba{100, 0, 0, 128}));
}

TEST(ComposeTest, ALayerThatCoversEverythingLiesOverAllOfThePicture) {
  const Mask line = mask_of(9, 1, {0, 0, 0, 0, 255, 0, 0, 0, 0});
  const PaintedClass everywhere{nullptr, {0, 200, 0, 255}};
  const PaintedClass lines{&line, {100, 0, 0, 255}};
  const Picture picture = compose({{&everywhere, 1}, nullptr, {}, {&lines, 1}, 1}, 9, 1);
  EXPECT_EQ(picture.at(0, 0), (Rgba{0, 200, 0, 255}));
  EXPECT_EQ(picture.at(4, 0), (Rgba{100, 0, 0, 255}));
  EXPECT_EQ(picture.at(8, 0), (Rgba{0, 200, 0, 255}));
}

// Along their border, colours change from one to the other in even steps, and the background does
// not show.
TEST(ComposeTest, ClassesThatMeetDoSoInFewColours) {
  const Mask west = testing::mask_by(256, 1, [](int column, int) { return 255 - column; });
  const Mask east = testing::mask_by(256, 1, [](int column, int) { return column; });
  const std::vector<PaintedClass> classes{{&west, {250, 0, 90, 255}}, {&east, {10, 0, 90, 255}}};
  const PaintedLayer layer{.classes = classes};
  RunPicture picture;
  Composer().compose({&layer, 1}, 256, 1, kTransparent, Quality::bounded, picture);
  EXPECT_LE(picture.colours.size(), 32u) << "240 in steps of 8";
  for (int i = 0; i < 256; ++i) {
    const Rgba colour = picture.at(i, 0);
    EXPECT_NEAR(colour.r, 250 - 240.0 * i / 255, kMostChange + 0.51);
    EXPECT_EQ(colour.b, 90);
    EXPECT_EQ(colour.a, 255);
  }
}

// With more masks than a key can hold, another code path is used.
TEST(ComposeTest, ManyClassesAreMixedAsFewAre) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  constexpr int kClasses = 40;
  std::vector<Mask> masks;
  for (int i = 0; i < kClasses; ++i) {
    std::vector<int> values(50 * 20, 0);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (static_cast<int>(k / 3) % kClasses == i) values[k] = static_cast<int>(random() % 256);
    }
    masks.push_back(mask_of(50, 20, values));
  }
  std::vector<PaintedClass> classes;
  for (int i = 0; i < kClasses; ++i) {
    classes.push_back(
        {&masks[static_cast<std::size_t>(i)], {static_cast<std::uint8_t>(6 * i), 90, 30, 255}});
  }
  const Picture picture = compose(PaintedLayer{.classes = classes}, 50, 20, {255, 255, 255, 255});
  for (int i = 0; i < kClasses; ++i) {
    const PaintedLayer one{.classes = {&classes[static_cast<std::size_t>(i)], 1}};
    const Picture alone = compose(one, 50, 20, {255, 255, 255, 255});
    for (std::size_t k = 0; k < picture.pixels.size(); ++k) {
      if (static_cast<int>(k / 3) % kClasses != i) continue;
      EXPECT_EQ(picture.pixels[k], alone.pixels[k]);
    }
  }
}

TEST(ComposeTest, RefusesAMaskOfAnotherSize) {
  const Mask mask = mask_of(2, 1, {1, 2});
  const PaintedClass layer{&mask, {1, 2, 3, 255}};
  EXPECT_THROW(compose({&layer, 1}, 1, 2), std::invalid_argument);
}

}  // namespace
}  // namespace trapeze
