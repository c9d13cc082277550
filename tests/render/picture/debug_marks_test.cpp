#include "render/picture/debug_marks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/render/sample_mesh.h"

namespace trapeze {
namespace {

using testing::random_scatter;
using testing::SampleMesh;

constexpr Rgba kWhite{255, 255, 255, 255};
constexpr Rgba kBlack{0, 0, 0, 255};
constexpr int kCells = 16;  // cells in a pixel of the views below

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

/// '#' for black, '.' for white, '+' for anything in between.
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
  // Only its west side is in the picture, on the border between columns 1 and 2.
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
      const bool is_horizontal_side = std::abs(row - 9.5) < 1 || std::abs(row - 39.5) < 1;
      if (is_horizontal_side) continue;
      sum += here;
      if (here > 0) {
        EXPECT_LE(std::abs(column + 0.5 - line), 1.01) << column << ", " << row;
      }
    }
    if (row > 11 && row < 38) {
      EXPECT_NEAR(sum, 1, 0.02) << row;
    }
    if (row < 9 || row > 41) {
      EXPECT_EQ(sum, 0) << "above the trapezoid's top or below its bottom, row " << row;
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
  // Both sides extend beyond the top and the bottom: the corners at rows 4 and 8 are not vertices.
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

constexpr auto kByNumber = [](std::uint32_t trapezoid) { return trapezoid; };

/// The tint of a feature on white.
Rgba tint_on_white(std::uint32_t feature) {
  Picture picture = white_picture(1, 1);
  SampleMesh mesh;
  mesh.add_box(0, 0, kCells, kCells);
  const TrapezoidRange all = mesh.all();
  mark_faces(
      mesh.view(), {&all, 1}, [feature](std::uint32_t) { return feature; }, view_of(picture),
      picture);
  return picture.at(0, 0);
}

int distance(Rgba a, Rgba b) {
  return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
}

TEST(DebugMarksTest, FeaturesWhoseNumbersAreCloseHaveTintsThatAreNot) {
  for (std::uint32_t i = 0; i < 300; ++i) {
    for (std::uint32_t k = 1; k <= 4; ++k) {
      EXPECT_GT(distance(tint_on_white(i), tint_on_white(i + k)), 40) << i << " and " << i + k;
    }
  }
}

TEST(DebugMarksTest, FacesAreTintedByTheAreaThatTheyCover) {
  Picture picture = white_picture(6, 4);
  SampleMesh mesh;
  mesh.add_box(kCells, kCells, 3 * kCells + 4, 3 * kCells);  // up to a quarter of the fourth column
  mesh.add_box(3 * kCells + 4, kCells, 5 * kCells, 3 * kCells);
  const TrapezoidRange all = mesh.all();
  mark_faces(mesh.view(), {&all, 1}, kByNumber, view_of(picture), picture);
  const Rgba first = tint_on_white(0);
  const Rgba second = tint_on_white(1);
  for (int row = 0; row < 4; ++row) {
    const bool is_inside = row == 1 || row == 2;
    EXPECT_EQ(picture.at(0, row), kWhite);
    EXPECT_EQ(picture.at(5, row), kWhite);
    EXPECT_EQ(picture.at(2, row), is_inside ? first : kWhite);
    EXPECT_EQ(picture.at(4, row), is_inside ? second : kWhite);
    const Rgba mixed = picture.at(3, row);
    EXPECT_NEAR(mixed.r, is_inside ? (first.r + 3 * second.r) / 4 : 255, 1);
    EXPECT_NEAR(mixed.b, is_inside ? (first.b + 3 * second.b) / 4 : 255, 1);
  }
}

TEST(DebugMarksTest, FacesThatFillAPictureLeaveNothingUntintedBetweenThem) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  // Two fields on either side of a line at a random place, with a tint for both.
  for (int i = 0; i < 20; ++i) {
    Picture picture = white_picture(16, 16);
    const auto somewhere = [&random] { return static_cast<std::int32_t>(random() % 256); };
    SampleMesh mesh;
    const auto left = mesh.add_edge({-9, -9}, {-9, 999});
    const auto middle = mesh.add_edge({somewhere(), -9}, {somewhere(), 999});
    const auto right = mesh.add_edge({999, -9}, {999, 999});
    const std::int32_t height = somewhere();
    mesh.add(left, middle, -9, height);
    mesh.add(left, middle, height, 999);
    mesh.add(middle, right, -9, 999);
    const TrapezoidRange all = mesh.all();
    mark_faces(
        mesh.view(), {&all, 1}, [](std::uint32_t) { return 5u; }, view_of(picture), picture);
    const Rgba tint = tint_on_white(5);
    for (int row = 0; row < 16; ++row) {
      for (int column = 0; column < 16; ++column) {
        ASSERT_LE(distance(picture.at(column, row), tint), 3) << column << ", " << row;
      }
    }
  }
}

/// Three fields, A west of B and C. Each vertex is in the middle of a pixel.
///
///     0-------1-------2
///     |       |   B   |
///     |   A   3-------4
///     |       |   C   |
///     5-------6-------7
class ThreeFields {
 public:
  MeshView mesh() const { return {1, vertices_, edges_, trapezoids_}; }

  /// The marked junctions if only the trapezoids of the fields in `fields` are drawn.
  Rows junctions(const std::string& fields) const {
    std::vector<TrapezoidRange> ranges;
    std::vector<TrapezoidRange> horizontal_edges;
    for (std::uint32_t i = 0; i < trapezoids_.size(); ++i) {
      if (fields.find(kFieldOf[i]) == std::string::npos) continue;
      (trapezoids_[i].left == trapezoids_[i].right ? horizontal_edges : ranges).push_back({i, 1});
    }
    Picture picture = white_picture(15, 11);
    const auto field_of = [](std::uint32_t i) { return static_cast<std::uint32_t>(kFieldOf[i]); };
    mark_junctions(mesh(), ranges, horizontal_edges, field_of, view_of(picture), kBlack, picture);
    return drawing(picture);
  }

 private:
  static constexpr Point at(int column, int row) {
    return {column * kCells + kCells / 2, row * kCells + kCells / 2};
  }

  const std::vector<Point> vertices_ = {at(2, 2),  at(7, 2), at(12, 2), at(7, 5),
                                        at(12, 5), at(2, 8), at(7, 8),  at(12, 8)};
  const std::vector<MeshEdge> edges_ = {{0, 5}, {1, 3}, {3, 6}, {2, 4}, {4, 7},
                                        {0, 1}, {1, 2}, {3, 4}, {5, 6}, {6, 7}};
  const std::vector<MeshTrapezoid> trapezoids_ = {
      {0, 3, 0, 1}, {3, 5, 0, 2}, {1, 3, 1, 3}, {4, 6, 2, 4},  // with a height
      {0, 1, 5, 5}, {1, 2, 6, 6}, {3, 4, 7, 7}, {3, 4, 7, 7}, {5, 6, 8, 8}, {6, 7, 9, 9}};
  static constexpr std::string_view kFieldOf = "AABCABBCAC";
};

TEST(DebugMarksTest, JunctionsAreWhereThreeFeaturesMeetOfWhichOneMayBeTheOutside) {
  EXPECT_EQ(ThreeFields().junctions("ABC"), Rows({".......#.......",  //
                                                  "......###......",  //
                                                  ".....#####.....",  //
                                                  "......###...#..",  //
                                                  "......###..###.",  //
                                                  ".....##########",  //
                                                  "......###..###.",  //
                                                  "......###...#..",  //
                                                  ".....#####.....",  //
                                                  "......###......",  //
                                                  ".......#......."}));
}

TEST(DebugMarksTest, WhereAllButOneOrTwoFeaturesAreOutsideIsNoJunctionButWhereTheyPart) {
  const Rows none(11, std::string(15, '.'));
  EXPECT_EQ(ThreeFields().junctions("A"), none);
  EXPECT_EQ(ThreeFields().junctions("B"), none);
  EXPECT_EQ(ThreeFields().junctions(""), none);
  EXPECT_EQ(ThreeFields().junctions("BC"), Rows({"...............",  //
                                                 "...............",  //
                                                 "...............",  //
                                                 ".......#....#..",  //
                                                 "......###..###.",  //
                                                 ".....##########",  //
                                                 "......###..###.",  //
                                                 ".......#....#..",  //
                                                 "...............",  //
                                                 "...............",  //
                                                 "..............."}));
}

TEST(DebugMarksTest, TheBorderIsALineAroundThePicture) {
  Picture picture = white_picture(6, 4);
  mark_border(kBlack, picture);
  EXPECT_EQ(drawing(picture), Rows({"######",  //
                                    "#....#",  //
                                    "#....#",  //
                                    "######"}));
}

TEST(DebugMarksTest, TheBorderOfTheSmallestPictureIsItsOnlyPixel) {
  Picture picture = white_picture(1, 1);
  mark_border(kBlack, picture);
  EXPECT_EQ(drawing(picture), Rows({"#"}));
}

}  // namespace
}  // namespace trapeze
