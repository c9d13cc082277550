#include "render/picture/reduce_colours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <set>
#include <vector>

#include "render/picture/compose.h"
#include "tests/render/masks.h"

namespace trapeze {
namespace {

constexpr int kSide = 96;

// Premultiplied by the opacity.
std::vector<double> exact_channels_of(Rgba colour) {
  const double share = colour.a / 255.0;
  return {colour.r * share, colour.g * share, colour.b * share, static_cast<double>(colour.a)};
}

struct Change {
  double most = 0;
  double mean = 0;
};

Change change_between(const RunPicture& a, const RunPicture& b) {
  const Picture before = to_pixels(a);
  const Picture after = to_pixels(b);
  Change change;
  for (std::size_t i = 0; i < before.pixels.size(); ++i) {
    const auto from = exact_channels_of(before.pixels[i]);
    const auto to = exact_channels_of(after.pixels[i]);
    for (std::size_t c = 0; c < from.size(); ++c) {
      change.most = std::max(change.most, std::abs(from[c] - to[c]));
      change.mean += std::abs(from[c] - to[c]);
    }
  }
  change.mean /= 4.0 * static_cast<double>(before.pixels.size());
  return change;
}

// A disc with soft edges at a random place.
Mask disc(std::mt19937& random) {
  std::uniform_real_distribution<double> place(0, kSide);
  const double x = place(random);
  const double y = place(random);
  const double radius = 4 + place(random) / 3;
  return testing::mask_by(kSide, kSide, [&](int column, int row) {
    const double inside = radius - std::hypot(column - x, row - y) + 0.5;
    return std::clamp(inside, 0.0, 1.0) * 255 + 0.5;
  });
}

Rgba random_colour(std::mt19937& random, bool is_opaque) {
  const auto byte = [&random] { return static_cast<std::uint8_t>(random() % 256); };
  return {byte(), byte(), byte(), is_opaque ? std::uint8_t{255} : byte()};
}

// Reduces the colours and returns the sum of the changes.
std::uint64_t reduce(RunPicture& picture, int most_change) {
  std::vector<std::uint32_t> pixels(picture.colours.size(), 0);
  for (int row = 0; row < picture.height; ++row) {
    std::uint32_t begin = 0;
    for (const Run& run : picture.row(row)) {
      pixels[run.colour] += run.end - begin;
      begin = run.end;
    }
  }
  ColourReducer reducer;
  const auto sum = reducer.reduce(picture.colours, picture.origins, pixels, most_change);
  const RunPicture before = picture;
  recolour(before.runs, before.row_end, reducer.becomes(), picture);
  picture.colours = reducer.colours();
  picture.origins = reducer.origins();
  return sum;
}

struct Discs {
  std::vector<Mask> masks;
  std::vector<PaintedClass> classes;
  Rgba background;

  Discs(int count, Rgba below, bool are_opaque, std::mt19937& random) : background(below) {
    for (int i = 0; i < count; ++i) masks.push_back(disc(random));
    for (const Mask& mask : masks) classes.push_back({&mask, random_colour(random, are_opaque)});
  }
  RunPicture picture(Quality quality) const {
    RunPicture picture;
    Composer().compose(plain_layers(classes), kSide, kSide, background, quality, picture);
    return picture;
  }
};

class ReducedPicturesTest : public ::testing::TestWithParam<unsigned> {};

TEST_P(ReducedPicturesTest, KeepWithinTheBounds) {
  const unsigned seed = GetParam() == 0 ? std::random_device{}() : GetParam();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  int indexed = 0;
  for (int round = 0; round < 60; ++round) {
    const bool is_opaque = round % 2 == 0;
    const Rgba background = round % 3 == 0 ? kTransparent : random_colour(random, is_opaque);
    const Discs discs(1 + round % 7, background, is_opaque, random);
    const RunPicture exact = discs.picture(Quality::exact);
    const RunPicture bounded = discs.picture(Quality::bounded);
    EXPECT_LE(bounded.colours.size(), exact.colours.size());
    indexed += bounded.colours.size() <= kPaletteColours ? 1 : 0;
    const Change change = change_between(exact, bounded);
    EXPECT_LE(change.most, kMostChange + 1) << "both have been rounded; round " << round;
    EXPECT_LE(change.mean, kMostMeanChange + 0.1);
  }
  EXPECT_GT(indexed, 40);
}

// 0 means a new seed for each run; with the other seeds, half-opaque colours once moved too far
// when their opacity was rounded.
INSTANTIATE_TEST_SUITE_P(Seeds, ReducedPicturesTest,
                         ::testing::Values(0u, 1912497036u, 3910053737u, 4231520298u));

// All pixels are between two colours: the steps that suit edges would be too coarse.
TEST(ReduceColoursTest, AGreyPictureKeepsWithinTheMean) {
  std::mt19937 random(9);
  const Mask grey =
      testing::mask_by(kSide, kSide, [&random](int, int) { return 1 + random() % 254; });
  const PaintedClass black{&grey, {0, 0, 0, 255}};
  RunPicture exact;
  RunPicture bounded;
  const Rgba white{255, 255, 255, 255};
  Composer().compose(plain_layers({&black, 1}), kSide, kSide, white, Quality::exact, exact);
  Composer().compose(plain_layers({&black, 1}), kSide, kSide, white, Quality::bounded, bounded);
  EXPECT_LE(change_between(exact, bounded).mean, kMostMeanChange);
  EXPECT_LT(bounded.colours.size(), exact.colours.size());
}

TEST(ReduceColoursTest, FlatColoursAreExact) {
  std::mt19937 random(7);
  const Discs discs(5, {250, 249, 248, 255}, true, random);
  const RunPicture exact = discs.picture(Quality::exact);
  const Picture before = to_pixels(exact);
  const Picture after = to_pixels(discs.picture(Quality::bounded));
  int flat = 0;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const bool is_flat = std::ranges::all_of(discs.masks, [&](const Mask& mask) {
        return mask.at(column, row) == 0 || mask.at(column, row) == 255;
      });
      if (!is_flat) continue;
      ++flat;
      EXPECT_EQ(after.at(column, row), before.at(column, row));
    }
  }
  EXPECT_GT(flat, 1000);
}

// Prevents seams: an edge gets the same colours whatever else is in the tile.
TEST(ReduceColoursTest, AnEdgeHasTheSameColoursInEveryPicture) {
  constexpr int kRows = 32;
  const auto in_row = [](int row, const auto& value_of) {
    return testing::mask_by(256, kRows,
                            [&](int column, int y) { return y == row ? value_of(column) : 0; });
  };
  const Mask edge = in_row(0, [](int i) { return i; });
  const Mask other = in_row(1, [](int i) { return i < 128 ? 255 : 40; });
  const std::vector<PaintedClass> two{{&edge, {200, 210, 250, 255}}, {&other, {200, 30, 10, 255}}};
  const Rgba white{255, 255, 255, 255};
  const auto compose = [&](std::size_t classes) {
    RunPicture picture;
    const auto layers = plain_layers(std::span(two).first(classes));
    Composer().compose(layers, 256, kRows, white, Quality::bounded, picture);
    return picture;
  };
  const RunPicture one = compose(1);
  const RunPicture more = compose(2);
  EXPECT_LE(one.row(0).size(), 8u) << "in steps of 8 at most, from white to 200";
  for (int column = 0; column < 256; ++column) EXPECT_EQ(one.at(column, 0), more.at(column, 0));
}

TEST(ReduceColoursTest, WhatIsAsOpaqueEverywhereRemainsSo) {
  std::mt19937 random(8);
  Picture picture{64, 64, {}};
  for (int i = 0; i < 64 * 64; ++i) {
    Rgba colour = random_colour(random, false);
    colour.a = static_cast<std::uint8_t>(125 + random() % 5);
    picture.pixels.push_back(i == 0 ? Rgba{9, 9, 9, 127} : colour);
  }
  RunPicture runs = to_runs(picture);
  std::fill(runs.origins.begin() + 1, runs.origins.end(), Origin::mixed);
  reduce(runs, kMostChange);
  for (const Rgba colour : runs.colours) EXPECT_EQ(colour.a, 127);
}

RunPicture noise(bool are_opaque) {
  std::mt19937 random(3);
  Picture noise{64, 64, {}};
  for (int i = 0; i < 64 * 64; ++i) noise.pixels.push_back(random_colour(random, are_opaque));
  RunPicture picture = to_runs(noise);
  std::ranges::fill(picture.origins, Origin::mixed);
  return picture;
}

TEST(ReduceColoursTest, WhatHasTooManyColoursKeepsWithinTheBounds) {
  const RunPicture exact = noise(false);
  RunPicture picture = exact;
  reduce(picture, kMostChange);
  EXPECT_GT(picture.colours.size(), kPaletteColours);
  EXPECT_LE(change_between(exact, picture).most, kMostChange + 1);
}

TEST(ReduceColoursTest, TellsTheSumOfTheChanges) {
  const RunPicture exact = noise(true);
  RunPicture picture = exact;
  const auto sum = static_cast<double>(reduce(picture, 3));
  EXPECT_NEAR(sum / 4 / (64 * 64), change_between(exact, picture).mean, 1e-9);
  EXPECT_GT(sum, 0);
}

// Where the colours are few enough, this includes gathering them into a palette.
TEST(ReduceColoursTest, AColourThatComesSeveralTimesIsAsIfItCameOnce) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const int count : {50, 400, 1'000, 20'000}) {
    std::vector<Rgba> once;
    std::vector<Origin> origins;
    std::vector<std::uint32_t> pixels;
    std::set<std::uint32_t> met;
    for (int i = 0; i < count; ++i) {
      const auto byte = [&random] { return static_cast<std::uint8_t>(random() % 60); };
      const Rgba colour{byte(), byte(), 30, static_cast<std::uint8_t>(255 - byte() % 9)};
      if (!met.insert(bits_of(colour)).second) continue;
      once.push_back(colour);
      origins.push_back(static_cast<Origin>(random() % 40 == 0 ? random() % 2 : 2));
      pixels.push_back(static_cast<std::uint32_t>(2 + random() % 50));
    }
    // Some of them a second time, with mixed origin and one of the pixels.
    std::vector<Rgba> again = once;
    std::vector<Origin> origins_again = origins;
    std::vector<std::uint32_t> pixels_again = pixels;
    for (std::size_t i = 0; i < once.size(); i += 3) {
      again.push_back(once[i]);
      origins_again.push_back(Origin::mixed);
      pixels_again.push_back(1);
      --pixels_again[i];
    }
    for (const int change : {0, 1, kMostChange}) {
      ColourReducer of_once;
      ColourReducer of_again;
      EXPECT_EQ(of_once.reduce(once, origins, pixels, change),
                of_again.reduce(again, origins_again, pixels_again, change));
      EXPECT_EQ(of_once.colours(), of_again.colours());
      EXPECT_EQ(of_once.origins(), of_again.origins());
      for (std::size_t i = 0; i < once.size(); ++i) {
        EXPECT_EQ(of_once.becomes()[i], of_again.becomes()[i]);
      }
      for (std::size_t i = 0; i < once.size(); i += 3) {
        EXPECT_EQ(of_once.becomes()[i], of_again.becomes()[once.size() + i / 3]);
      }
    }
  }
}

TEST(ReduceColoursTest, WhatIsOpaqueRemainsSo) {
  RunPicture picture = noise(true);
  reduce(picture, kMostChange);
  for (const Rgba colour : picture.colours) EXPECT_EQ(colour.a, 255);
}

TEST(ReduceColoursTest, FlatColoursDoNotChange) {
  RunPicture picture = noise(true);
  const Picture before = to_pixels(picture);
  std::ranges::fill(picture.origins, Origin::flat);
  EXPECT_EQ(reduce(picture, kMostChange), 0u);
  EXPECT_EQ(to_pixels(picture).pixels, before.pixels);
}

// Colours around a few places, none of which fits the lattice well.
TEST(ReduceColoursTest, ColoursCloseToEachOtherFitIntoAPalette) {
  std::mt19937 random(4);
  Picture clusters{64, 64, {}};
  for (int i = 0; i < 64 * 64; ++i) {
    const auto near = [&](int place) { return static_cast<std::uint8_t>(place + random() % 7); };
    const int cluster = static_cast<int>(random() % 150);
    clusters.pixels.push_back({near(4 + cluster), near(13 + cluster / 2), near(22), 255});
  }
  const RunPicture exact = to_runs(clusters);
  RunPicture picture = exact;
  std::ranges::fill(picture.origins, Origin::mixed);
  reduce(picture, kMostChange);
  EXPECT_LE(picture.colours.size(), kPaletteColours);
  EXPECT_LE(change_between(exact, picture).most, kMostChange);
}

// The fewer pixels have a flat colour, the less the other colours may change.
TEST(ReduceColoursTest, OfAnExactPictureItKeepsWithinTheMean) {
  std::mt19937 random(6);
  for (const unsigned flat_of_ten : {0u, 5u, 9u}) {
    Picture noise{64, 64, {}};
    for (int i = 0; i < 64 * 64; ++i) {
      const bool is_flat = random() % 10 < flat_of_ten;
      noise.pixels.push_back(is_flat ? Rgba{0, 0, 0, 255} : random_colour(random, true));
    }
    const RunPicture exact = to_runs(noise);
    RunPicture picture = exact;
    std::ranges::fill(picture.origins, Origin::mixed);
    ColourReducer().reduce(picture);
    const Change change = change_between(exact, picture);
    EXPECT_LE(change.mean, kMostMeanChange) << flat_of_ten;
    EXPECT_EQ(change.mean > 0, flat_of_ten > 0) << flat_of_ten;
  }
}

TEST(ReduceColoursTest, EveryColourIsOfSomePixel) {
  std::mt19937 random(5);
  const Discs discs(4, kTransparent, true, random);
  for (const Quality quality : {Quality::bounded, Quality::exact}) {
    const RunPicture picture = discs.picture(quality);
    std::set<std::uint32_t> used;
    for (const auto& run : picture.runs) used.insert(run.colour);
    EXPECT_EQ(used.size(), picture.colours.size());
  }
}

}  // namespace
}  // namespace trapeze
