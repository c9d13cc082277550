#include "render/debug_marks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/render/sample_mesh.h"

namespace trapeze {
namespace {

using testing::random_scatter;
using testing::SampleMesh;

constexpr Rgba kWhite{255, 255, 255, 255};
constexpr Rgba kBlack{0, 0, 0, 255};
constexpr int kCells = 16;  // of a pixel, in the views below

Picture white_picture(int width, int height) {
  Picture picture;
  picture.width = width;
  picture.height = height;
  picture.pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kWhite);
  return picture;
}

View view_of(const Picture& picture, int column = 0, int row = 0) {
  return {column * kCells, row * kCells, kCells, picture.width, picture.height};
}

/// 0 where the picture is white, 1 where it is black.
double ink(const Picture& picture, int column, int row) {
  return 1 - picture.at(column, row).r / 255.0;
}

/// '#' for black, '.' for white, '+' for what lies between.
std::vector<std::string> drawing(const Picture& picture) {
  std::vector<std::string> rows;
  for (int row = 0; row < picture.height; ++row) {
    std::string& line = rows.emplace_back();
    for (int column = 0; column < picture.width; ++column) {
      const Rgba pixel = picture.at(column, row);
      line += pixel == kWhite ? '.' : pixel == kBlack ? '#' : '+';
    }
  }
  return rows;
}

using Rows = std::vector<std::string>;

TEST(DebugMarksTest, SpreadingAPaletteKeepsEveryColour) {
  Picture picture;
  picture.width = 3;
  picture.height = 1;
  picture.palette = {kTransparent, {1, 2, 3, 4}, kWhite};
  picture.indices = {2, 1, 0};
  spread_palette(picture);
  EXPECT_FALSE(picture.is_indexed());
  const std::vector<Rgba> colours = {kWhite, {1, 2, 3, 4}, kTransparent};
  EXPECT_EQ(picture.pixels, colours);
  spread_palette(picture);
  EXPECT_EQ(picture.pixels, colours);
}

TEST(DebugMarksTest, TheSidesOfATrapezoidAreDrawn) {
  Picture picture = white_picture(8, 6);
  SampleMesh mesh;
  mesh.add_box(24, 24, 104, 72);  // through the middles of columns 1 and 6, rows 1 and 4
  const TrapezoidRange all = mesh.all();
  mark_mesh(mesh.view(), {&all, 1}, view_of(picture), kBlack, picture);
  EXPECT_EQ(drawing(picture), Rows({"........",  //
                                    ".######.",  //
                                    ".#....#.",  //
                                    ".#....#.",  //
                                    ".######.",  //
                                    "........"}));
}

TEST(DebugMarksTest, ALineBetweenTwoPixelsIsSharedByThem) {
  Picture picture = white_picture(4, 4);
  SampleMesh mesh;
  // Only its west side is in the picture, on the border of columns 1 and 2.
  mesh.add_box(2 * kCells, -1000, 1000, 1000);
  const TrapezoidRange all = mesh.all();
  mark_mesh(mesh.view(), {&all, 1}, view_of(picture), kBlack, picture);
  for (int row = 0; row < 4; ++row) {
    EXPECT_EQ(ink(picture, 0, row), 0);
    EXPECT_NEAR(ink(picture, 1, row), 0.5, 0.01);
    EXPECT_NEAR(ink(picture, 2, row), 0.5, 0.01);
    EXPECT_EQ(ink(picture, 3, row), 0);
  }
}

TEST(DebugMarksTest, ASlantedSideIsWithoutGapsAndStaysOnItsLine) {
  Picture picture = white_picture(40, 60);
  SampleMesh mesh;
  // From (5, 3) to (30, 53), in pixels; the other side is far east.
  const auto left = mesh.add_edge({5 * kCells, 3 * kCells}, {30 * kCells, 53 * kCells});
  const auto right = mesh.add_edge({9000, 3 * kCells}, {9000, 53 * kCells});
  mesh.add(left, right, 10 * kCells, 40 * kCells);
  const TrapezoidRange all = mesh.all();
  mark_mesh(mesh.view(), {&all, 1}, view_of(picture), kBlack, picture);
  for (int row = 0; row < 60; ++row) {
    double sum = 0;
    for (int column = 0; column < 40; ++column) {
      const double here = ink(picture, column, row);
      const double line = 5 + (row + 0.5 - 3) / 2;
      const bool is_level_side = std::abs(row - 9.5) < 1 || std::abs(row - 39.5) < 1;
      if (is_level_side) continue;
      sum += here;
      if (here > 0) {
        EXPECT_LE(std::abs(column + 0.5 - line), 1.01) << column << ", " << row;
      }
    }
    if (row > 11 && row < 38) {
      EXPECT_NEAR(sum, 1, 0.02) << row;
    }
    if (row < 9 || row > 41) {
      EXPECT_EQ(sum, 0) << "beyond the trapezoid's levels, row " << row;
    }
  }
}

TEST(DebugMarksTest, WhatIsDrawnDoesNotDependOnWhereThePictureIsCut) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const SampleMesh mesh = random_scatter(random, {-800, -800, 2400, 2400}, 60);
  const TrapezoidRange all = mesh.all();
  const auto draw = [&](int column, int row, int size) {
    Picture picture = white_picture(size, size);
    const View view = view_of(picture, column, row);
    mark_mesh(mesh.view(), {&all, 1}, view, {0, 0, 0, 100}, picture);
    mark_vertices(mesh.view(), {&all, 1}, view, {255, 0, 0, 255}, picture);
    return picture;
  };
  const Picture large = draw(0, 0, 100);
  const Picture part = draw(30, 50, 25);
  for (int row = 0; row < 25; ++row) {
    for (int column = 0; column < 25; ++column) {
      const Rgba expected = large.at(30 + column, 50 + row);
      const Rgba actual = part.at(column, row);
      EXPECT_LE(std::abs(expected.g - actual.g), 2) << column << ", " << row;
      EXPECT_LE(std::abs(expected.r - actual.r), 2) << column << ", " << row;
    }
  }
}

TEST(DebugMarksTest, NothingIsDrawnBesideThePictureHoweverLargeTheTrapezoids) {
  constexpr std::int32_t kFar = std::numeric_limits<std::int32_t>::max() / 2;
  SampleMesh mesh;
  mesh.add_box(-kFar, -kFar, kFar, kFar);
  mesh.add(mesh.add_edge({-kFar, -kFar}, {kFar, kFar}), mesh.add_edge({kFar, -kFar}, {kFar, kFar}),
           -kFar, kFar);
  mesh.add_box(-40, -40, 0, 0);
  const TrapezoidRange all = mesh.all();
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{1, 9}, std::pair{9, 1}}) {
    Picture picture = white_picture(width, height);
    const std::size_t pixels = picture.pixels.size();
    mark_mesh(mesh.view(), {&all, 1}, view_of(picture), kBlack, picture);
    mark_vertices(mesh.view(), {&all, 1}, view_of(picture), kBlack, picture);
    EXPECT_EQ(picture.pixels.size(), pixels);
    EXPECT_EQ(picture.at(0, 0), kBlack) << "the vertex at the corner";
  }
}

TEST(DebugMarksTest, EveryEndOfAnEdgeIsMarkedAndNoImpliedCorner) {
  Picture picture = white_picture(12, 12);
  SampleMesh mesh;
  // Both sides reach beyond the levels: the corners at rows 4 and 8 are no vertices.
  const auto left = mesh.add_edge({2 * kCells + 8, 8}, {2 * kCells + 8, 10 * kCells + 8});
  const auto right = mesh.add_edge({9 * kCells + 8, 8}, {9 * kCells + 8, 10 * kCells + 8});
  mesh.add(left, right, 4 * kCells + 8, 8 * kCells + 8);
  const TrapezoidRange all = mesh.all();
  mark_vertices(mesh.view(), {&all, 1}, view_of(picture), kBlack, picture);
  EXPECT_EQ(drawing(picture), Rows({".###....###.",  //
                                    ".###....###.",  //
                                    "............",  //
                                    "............",  //
                                    "............",  //
                                    "............",  //
                                    "............",  //
                                    "............",  //
                                    "............",  //
                                    ".###....###.",  //
                                    ".###....###.",  //
                                    ".###....###."}));
}

TEST(DebugMarksTest, TheBorderIsALineAroundThePictureWithItsTextInTheCorner) {
  Picture picture = white_picture(64, 48);
  mark_border("7", kBlack, picture);
  for (int row = 0; row < 48; ++row) {
    for (int column = 0; column < 64; ++column) {
      const bool is_border = row == 0 || row == 47 || column == 0 || column == 63;
      const bool is_text = column >= 5 && column < 11 && row >= 5 && row < 15;
      if (is_border) {
        EXPECT_EQ(picture.at(column, row), kBlack) << column << ", " << row;
      } else if (!is_text) {
        EXPECT_EQ(picture.at(column, row), kWhite) << column << ", " << row;
      }
    }
  }
  Rows glyph;
  for (const std::string& line : drawing(picture)) glyph.push_back(line.substr(5, 6));
  EXPECT_EQ(Rows(glyph.begin() + 5, glyph.begin() + 15),
            Rows({"######", "######", "....##", "....##", "..##..", "..##..", "..##..", "..##..",
                  "..##..", "..##.."}));
}

TEST(DebugMarksTest, TheTextIsReadableOnAnyGround) {
  Picture picture = white_picture(64, 32);
  std::ranges::fill(picture.pixels, kBlack);
  mark_border("1", kBlack, picture);
  EXPECT_EQ(picture.at(3, 3), kWhite);
  EXPECT_EQ(picture.at(3, 16), kWhite);
  EXPECT_EQ(picture.at(3, 17), kBlack) << "below the plate";
  EXPECT_EQ(picture.at(7, 14), kBlack) << "the foot of the digit";
}

TEST(DebugMarksTest, EveryCharacterOfATilesNumbersLooksDifferent) {
  const std::string characters = "0123456789/x ";
  std::set<Rows> drawings;
  for (const char c : characters) {
    Picture picture = white_picture(20, 20);
    mark_border(std::string(1, c), kBlack, picture);
    drawings.insert(drawing(picture));
  }
  EXPECT_EQ(drawings.size(), characters.size());
}

TEST(DebugMarksTest, ATextLongerThanThePictureIsCutOff) {
  for (const int size : {1, 2, 7, 30}) {
    Picture picture = white_picture(size, size);
    mark_border("22/4194303/4194303 4x", kBlack, picture);
    EXPECT_EQ(picture.pixels.size(),
              static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    EXPECT_EQ(picture.at(0, 0), kBlack);
    EXPECT_EQ(picture.at(0, size - 1), kBlack);
  }
}

}  // namespace
}  // namespace trapeze
