#include "core/mesh/visible_parts.h"

#include <gmock/gmock.h>

#include <map>
#include <random>

#include "core/grid/cancellation.h"
#include "tests/core/shapes/layers.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {
namespace {

using ::testing::IsEmpty;

/// The trapezoids of every feature of a layer at full detail.
std::vector<std::vector<std::uint32_t>> trapezoids_by_row(const Layer& layer) {
  std::vector<TrapezoidRange> ranges;
  Layer::Selection selection{layer.bounds(), 0, kLastLevel, SmallPolygons::drop};
  layer.select(selection, ranges);
  std::vector<std::vector<std::uint32_t>> by_row(layer.features().size());
  for_each_trapezoid(ranges, [&](std::uint32_t i) { by_row[layer.feature_of(i)].push_back(i); });
  return by_row;
}

double x_at(const MeshView& mesh, std::uint32_t edge, double y) {
  return EdgeLine(mesh, edge).x_at(y);
}

double area_of(const MeshView& mesh, const TrapezoidPart& part) {
  const double middle = (static_cast<double>(part.top) + part.bottom) / 2;
  return (x_at(mesh, part.right, middle) - x_at(mesh, part.left, middle)) *
         (static_cast<double>(part.bottom) - part.top);
}

/// The shares of the parts that contain the point, usually one.
std::vector<float> shares_at(const MeshView& mesh, std::span<const TrapezoidPart> parts, double x,
                             double y) {
  std::vector<float> shares;
  for (const TrapezoidPart& part : parts) {
    if (y < part.top || y >= part.bottom) continue;
    if (x < x_at(mesh, part.left, y) || x >= x_at(mesh, part.right, y)) continue;
    shares.push_back(part.share);
  }
  return shares;
}

struct Cut {
  std::unique_ptr<Layer> layer;
  VisibleParts parts;
};

/// The first polygon, covered by all others.
Cut cut_first(std::vector<Rings> polygons, float share) {
  Cut cut{layer_of(std::move(polygons)), {}};
  const MeshView& mesh = cut.layer->mesh();
  const auto by_row = trapezoids_by_row(*cut.layer);
  std::vector<Sheet> sheets(by_row.size());
  for (std::size_t row = 1; row < by_row.size(); ++row) sheets[row].assign(mesh, by_row[row]);
  cut.parts.begin(mesh);
  CancellationCheck check(nullptr, 100);
  for (const std::uint32_t trapezoid : by_row[0]) {
    cut.parts.add(trapezoid);
    for (std::size_t row = 1; row < by_row.size(); ++row) {
      cut.parts.cover(sheets[row], share, check);
    }
  }
  return cut;
}

double area_of(const Cut& cut) {
  double area = 0;
  for (const TrapezoidPart& part : cut.parts.parts()) area += area_of(cut.layer->mesh(), part);
  return area;
}

TEST(VisiblePartsTest, ASquareThatIsCoveredIsGone) {
  const Cut cut = cut_first({rings_from_text("0 0, 100 0, 100 100, 0 100"),
                             rings_from_text("-10 0, 100 0, 120 100, -10 100")},
                            0);
  EXPECT_THAT(cut.parts.parts(), IsEmpty());
}

TEST(VisiblePartsTest, WhatLiesBesideIsLeftWhole) {
  const Cut cut = cut_first({rings_from_text("0 0, 100 0, 80 100, 0 100"),
                             rings_from_text("100 0, 200 0, 200 100, 80 100"),
                             rings_from_text("0 100, 80 100, 80 200, 0 200")},
                            0);
  ASSERT_EQ(cut.parts.parts().size(), 1u);
  EXPECT_DOUBLE_EQ(area_of(cut), 9000);
}

TEST(VisiblePartsTest, AHoleIsCutAsLargeAsWhatLiesOver) {
  const Cut cut = cut_first({rings_from_text("0 0, 1000 0, 1000 1000, 0 1000"),
                             rings_from_text("500 100, 900 500, 500 900, 100 500")},
                            0);
  EXPECT_DOUBLE_EQ(area_of(cut), 1'000'000 - 320'000);
}

TEST(VisiblePartsTest, ThroughWhatLiesOverItAShareIsSeen) {
  const Cut cut = cut_first(
      {rings_from_text("0 0, 100 0, 100 100, 0 100"), rings_from_text("0 0, 50 0, 50 100, 0 100"),
       rings_from_text("0 0, 100 0, 100 50, 0 50")},
      0.5F);
  std::map<float, double> areas;
  for (const TrapezoidPart& part : cut.parts.parts()) {
    areas[part.share] += area_of(cut.layer->mesh(), part);
  }
  EXPECT_EQ(areas, (std::map<float, double>{{0.25F, 2500}, {0.5F, 5000}, {1.0F, 2500}}));
}

TEST(VisiblePartsTest, BelowMoreThanCanBeToldFromEachOtherThereIsNothing) {
  constexpr int kDepth = 8;  // halvings: 1/256, as 1/512 would be less than kLeastShare
  std::mt19937 random(5);
  std::vector<Rings> polygons(1);
  polygons.front().add(std::vector<Point>{{-50, -50}, {50, -50}, {50, 50}, {-50, 50}});
  while (polygons.size() <= kDepth) {
    polygons.emplace_back();
    polygons.back().add(random_star(random, {0, 0}, 12, 400, 900));
  }
  const Cut seen = cut_first(polygons, 0.5F);
  ASSERT_FALSE(seen.parts.parts().empty());
  for (const TrapezoidPart& part : seen.parts.parts()) EXPECT_EQ(part.share, 1.0F / 256);
  while (polygons.size() < 200) {
    polygons.emplace_back();
    polygons.back().add(random_star(random, {0, 0}, 12, 400, 900));
  }
  EXPECT_THAT(cut_first(polygons, 0.5F).parts.parts(), IsEmpty());
}

TEST(VisiblePartsTest, OfStarsEveryPointIsSeenAsOftenAsThereIsNothingAbove) {
  std::size_t seen = 0;
  std::size_t hidden = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    std::vector<Rings> stars;
    for (int i = 0; i < 4; ++i) {
      const auto x = static_cast<std::int32_t>(random() % 1000);
      const auto y = static_cast<std::int32_t>(random() % 1000);
      stars.emplace_back();
      stars.back().add(random_star(random, {x, y}, 15, 200, 2000));
    }
    const float share = seed % 2 == 0 ? 0.0F : 0.5F;
    const Cut cut = cut_first(stars, share);
    for (int k = 0; k < 400; ++k) {
      const double x = static_cast<int>(random() % 4000) - 1500 + 0.37;
      const double y = static_cast<int>(random() % 4000) - 1500 + 0.43;
      std::vector<float> expected;
      if (is_inside(stars[0], x, y)) {
        float left = 1;
        for (std::size_t i = 1; i < stars.size(); ++i) {
          if (is_inside(stars[i], x, y)) left *= share;
        }
        if (left > 0) expected.push_back(left);
        ++(left > 0 ? seen : hidden);
      }
      // Heights are rounded to cells, so a point may lie in a sliver beside a crossing.
      const auto shares = [&](double dx) {
        return shares_at(cut.layer->mesh(), cut.parts.parts(), x + dx, y);
      };
      EXPECT_TRUE(shares(0) == expected || shares(-3) == expected || shares(3) == expected)
          << "seed " << seed << " at " << x << ' ' << y;
    }
  }
  EXPECT_GT(seen, 3000u);
  EXPECT_GT(hidden, 2000u);
}

TEST(VisiblePartsTest, PartsAndWhatCutThemAddUp) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    std::vector<Rings> stars(2);
    for (Rings& star : stars) {
      star.add(random_star(random, {static_cast<std::int32_t>(random() % 1000), 0}, 30, 20'000,
                           200'000));
    }
    const double whole = area_of(cut_first({stars[0]}, 0));
    const Cut halved = cut_first(stars, 0.5F);
    const Cut cut = cut_first(stars, 0);
    // The area visible through the other polygon plus the area visible without it is the whole.
    EXPECT_NEAR(area_of(halved), whole, 1e-6 * whole) << seed;
    EXPECT_LT(area_of(cut), whole) << seed;
  }
}

TEST(VisiblePartsTest, NothingIsLeftOfWhatWasCancelled) {
  const auto layer =
      layer_of({rings_from_text("0 0, 100 0, 100 100, 0 100"),
                rings_from_text("20 10, 80 10, 80 30, 20 30; 20 40, 80 40, 80 60, 20 60"),
                rings_from_text("40 5, 60 5, 60 95, 40 95")});
  const auto by_row = trapezoids_by_row(*layer);
  std::vector<Sheet> sheets(3);
  for (const std::size_t row : {1, 2}) sheets[row].assign(layer->mesh(), by_row[row]);
  const auto cut = [&](VisibleParts& parts, CancellationCheck check) {
    parts.begin(layer->mesh());
    for (const std::uint32_t trapezoid : by_row[0]) {
      parts.add(trapezoid);
      for (const std::size_t row : {1, 2}) parts.cover(sheets[row], 0, check);
    }
    return std::vector<TrapezoidPart>(parts.parts().begin(), parts.parts().end());
  };
  Cancellation cancelled;
  cancelled.cancel();
  VisibleParts fresh;
  const auto expected = cut(fresh, CancellationCheck(nullptr, 1));
  for (unsigned steps = 1; steps < 30; ++steps) {
    VisibleParts parts;
    try {
      cut(parts, CancellationCheck(&cancelled, steps));
    } catch (const Cancelled&) {
    }
    EXPECT_EQ(cut(parts, CancellationCheck(nullptr, 1)), expected) << "after " << steps << " steps";
  }
}

}  // namespace
}  // namespace trapeze
