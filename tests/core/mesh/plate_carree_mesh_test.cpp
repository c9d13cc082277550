#include "core/mesh/plate_carree_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/grid/plate_carree.h"

namespace trapeze {
namespace {

constexpr Box kWholeGrid{kGridMin, kGridMin, kGridMax, kGridMax};
constexpr double kCellsPerRow = 1 << 21;  // the world is 512 rows high

struct Arrays {
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<MeshTrapezoid> trapezoids;

  MeshView view() const { return {0, vertices, edges, trapezoids}; }
};

/// Strips side by side between two rows, from the west of the grid to its east, with slanted sides.
Arrays strips(std::mt19937& random, std::int32_t top, std::int32_t bottom, int count) {
  Arrays made;
  const std::int64_t step = kGridSize / count;
  const auto any = [&](std::int64_t x) {
    return static_cast<std::int32_t>(x + static_cast<std::int64_t>(random() % step));
  };
  for (int i = 0; i <= count; ++i) {
    const bool is_end = i == 0 || i == count;
    const std::int64_t x = i == count ? kGridMax : kGridMin + i * step;
    const auto v = static_cast<std::uint32_t>(made.vertices.size());
    made.vertices.push_back({is_end ? static_cast<std::int32_t>(x) : any(x), top});
    made.vertices.push_back({is_end ? static_cast<std::int32_t>(x) : any(x), bottom});
    made.edges.push_back({v, v + 1});
    if (i == 0) continue;
    const auto e = static_cast<std::uint32_t>(made.edges.size());
    made.trapezoids.push_back({0, 1, e - 2, e - 1});
  }
  return made;
}

double area_of(const PlateCarreeMesh& mesh) {
  double area = 0;
  const MeshView view{0, mesh.vertices(), mesh.edges(), mesh.trapezoids()};
  for (const MeshTrapezoid& t : view.trapezoids) {
    const double top = view.vertices[t.top].y;
    const double bottom = view.vertices[t.bottom].y;
    const double middle = (top + bottom) / 2;
    area += (bottom - top) *
            (EdgeLine(view, t.right).x_at(middle) - EdgeLine(view, t.left).x_at(middle));
  }
  return area;
}

TEST(PlateCarreeMeshTest, NeighboursNeitherOverlapNorGape) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (int i = 0; i < 50; ++i) {
    const auto top = static_cast<std::int32_t>(random() % kGridMax) - kGridMax;
    const auto bottom = top + 1 + static_cast<std::int32_t>(random() % kGridMax);
    const Arrays made = strips(random, top, bottom, 1 + static_cast<int>(random() % 40));
    PlateCarreeMesh mesh;
    mesh.begin(kCellsPerRow, kWholeGrid);
    const TrapezoidRange all{0, static_cast<std::uint32_t>(made.trapezoids.size())};
    mesh.add(made.view(), {&all, 1});
    const double whole = (static_cast<double>(plate_carree_row(bottom)) - plate_carree_row(top)) *
                         static_cast<double>(kGridSize);
    EXPECT_NEAR(area_of(mesh) / whole, 1, 1e-12);
  }
}

// Points of the sides, converted back to the grid, are near the edges that the sides represent.
TEST(PlateCarreeMeshTest, SidesAreNearTheirCurves) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  double worst = 0;
  std::size_t pieces = 0;
  for (int i = 0; i < 200; ++i) {
    const auto top = static_cast<std::int32_t>(random() % kGridMax) - kGridMax;
    const auto bottom = top + 1'000 + static_cast<std::int32_t>(random() % kGridMax);
    const Arrays made = strips(random, top, bottom, 2);
    PlateCarreeMesh mesh;
    mesh.begin(kCellsPerRow, kWholeGrid);
    const TrapezoidRange first{0, 1};
    mesh.add(made.view(), {&first, 1});
    const EdgeLine edge(made.vertices[2], made.vertices[3]);
    const double slope = std::abs((static_cast<double>(made.vertices[3].x) - made.vertices[2].x) /
                                  (static_cast<double>(bottom) - top));
    const MeshView view{0, mesh.vertices(), mesh.edges(), mesh.trapezoids()};
    pieces += view.trapezoids.size();
    for (const MeshTrapezoid& t : view.trapezoids) {
      const EdgeLine side(view, t.right);
      for (const double part : {0.0, 0.3, 0.5, 0.8, 1.0}) {
        const double row =
            view.vertices[t.top].y +
            part * (static_cast<double>(view.vertices[t.bottom].y) - view.vertices[t.top].y);
        const double y = mercator_from_plate_carree(row);
        // The vertical distance from the side to the edge, in cells of plate carree, upwards.
        const double off =
            std::abs(side.x_at(row) - edge.x_at(y)) / (slope * mercator_stretch(y) + 1);
        worst = std::max(worst, off / kCellsPerRow);
      }
    }
  }
  EXPECT_LE(worst, PlateCarreeMesh::kMostCurved);
  EXPECT_GT(pieces, 400u) << "nothing was cut";
}

TEST(PlateCarreeMeshTest, WhatIsUprightOrLowIsNotCut) {
  Arrays made;
  append_box({-1000, kGridMin, 1000, kGridMax}, made.vertices, made.edges, made.trapezoids);
  const TrapezoidRange all{0, 1};
  PlateCarreeMesh mesh;
  mesh.begin(kCellsPerRow, kWholeGrid);
  mesh.add(made.view(), {&all, 1});
  EXPECT_EQ(mesh.trapezoids().size(), 1u);
  std::mt19937 random(1);
  const Arrays low = strips(random, 5, 4'000'000, 1);
  mesh.begin(kCellsPerRow, kWholeGrid);
  mesh.add(low.view(), {&all, 1});
  EXPECT_EQ(mesh.trapezoids().size(), 1u);
}

TEST(PlateCarreeMeshTest, OnlyWhatLiesInTheBoxIsMade) {
  std::mt19937 random(2);
  const Arrays made = strips(random, kGridMin, kGridMax, 3);
  const TrapezoidRange all{0, 3};
  PlateCarreeMesh mesh;
  mesh.begin(64, {kGridMin, 1'000'000, kGridMax, 1'100'000});
  mesh.add(made.view(), {&all, 1});
  EXPECT_LT(mesh.trapezoids().size(), 40u) << "the whole would be cut into thousands";
  EXPECT_GE(mesh.trapezoids().size(), 3u);
}

TEST(PlateCarreeMeshTest, AWayLeadsFromEndToEnd) {
  PlateCarreeMesh mesh;
  mesh.begin(kCellsPerRow, kWholeGrid);
  const Point south{-500'000'000, 700'000'000};
  const Point north{400'000'000, -900'000'000};
  std::vector<PlateCarreeMesh::PointOnWay> up;
  std::vector<PlateCarreeMesh::PointOnWay> down;
  mesh.cut(south, north, up);
  mesh.cut(north, south, down);
  ASSERT_GT(up.size(), 10u);
  ASSERT_EQ(up.size(), down.size());
  for (std::size_t i = 0; i < up.size(); ++i) {
    EXPECT_EQ(up[i].place, down[down.size() - 1 - i].place);
    EXPECT_NEAR(up[i].share, 1 - down[down.size() - 1 - i].share, 1e-12);
    if (i > 0) {
      EXPECT_GT(up[i].share, up[i - 1].share);
    }
  }
  EXPECT_EQ(up.front().place, mesh.projected(south));
  EXPECT_EQ(up.back().place, mesh.projected(north));
  EXPECT_EQ(up.front().share, 0);
  EXPECT_EQ(up.back().share, 1);
  mesh.cut({5, 5}, {5, 5}, up);
  EXPECT_TRUE(up.empty()) << "a line has two ends";
}

}  // namespace
}  // namespace trapeze
