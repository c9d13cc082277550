#include "core/borders/coverage_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/borders/coverage_builder.h"
#include "core/grid/web_mercator.h"
#include "tests/core/borders/coverage_shapes.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

CoverageFaults faults_of(const std::vector<std::string>& texts) {
  std::vector<Rings> features;
  for (const std::string& text : texts) features.push_back(rings_from_text(text));
  return find_faults(pointers_to(features));
}

std::size_t count(const CoverageFaults& found, FaultKind kind) {
  return static_cast<std::size_t>(
      std::ranges::count(found.faults, kind, [](const CoverageFault& f) { return f.kind; }));
}

TEST(CoverageFaults, NeighboursThatFitHaveNone) {
  const auto found = faults_of({"0 0, 10 0, 10 10, 0 10", "10 0, 20 0, 20 10, 10 10"});
  EXPECT_THAT(found.faults, IsEmpty());
  EXPECT_EQ(found.failure, "");
}

TEST(CoverageFaults, AGapHasItsAreaItsWidthAndThoseAroundIt) {
  // A strip of 2 x 100 cells between two features, closed by a third and a fourth.
  const auto found = faults_of({"0 0, 100 0, 100 100, 0 100", "102 0, 200 0, 200 100, 102 100",
                                "0 -10, 200 -10, 200 0, 102 0, 100 0, 0 0",
                                "0 100, 100 100, 102 100, 200 100, 200 110, 0 110"});
  ASSERT_EQ(found.faults.size(), 1u);
  const CoverageFault& gap = found.faults[0];
  EXPECT_EQ(gap.kind, FaultKind::gap);
  EXPECT_THAT(gap.features, ElementsAre(0, 1, 2, 3));
  const double metre = cells_from_ground(1, 0);
  EXPECT_NEAR(gap.area * metre * metre, 200, 0.01);
  EXPECT_NEAR(gap.width * metre, 200.0 / 102, 0.01);
  ASSERT_EQ(gap.polygons.size(), 1u);
  EXPECT_EQ(gap.polygons.rings.points.size(), 4u);
}

TEST(CoverageFaults, AGapThatIsLargeHasItsAreaOnTheGround) {
  // 10 by 40 degrees, between two features.
  const auto at = [](double lon, double lat) {
    const GridPosition cell = grid_from_lonlat({lon, lat});
    return std::to_string(std::lrint(cell.x)) + " " + std::to_string(std::lrint(cell.y));
  };
  const auto ring = [&at](const std::vector<LonLat>& places) {
    std::string text;
    for (const LonLat& p : places) text += (text.empty() ? "" : ", ") + at(p.lon, p.lat);
    return text;
  };
  const auto found = faults_of(
      {ring({{0, 0}, {10, 0}, {10, 10}, {5, 10}, {5, 50}, {10, 50}, {10, 60}, {0, 60}}),
       ring({{10, 0}, {20, 0}, {20, 60}, {10, 60}, {10, 50}, {15, 50}, {15, 10}, {10, 10}})});
  ASSERT_EQ(found.faults.size(), 1u);
  const double radian = std::numbers::pi / 180;
  const double radius = kCellsPerRadian / cells_from_ground(1, 0);
  const double area =
      radius * radius * 10 * radian * (std::sin(50 * radian) - std::sin(10 * radian));
  EXPECT_NEAR(found.faults[0].area / area, 1, 1e-6);
}

TEST(CoverageFaults, AnOverlapHasThoseThatCoverIt) {
  const auto found =
      faults_of({"0 0, 10 0, 10 10, 0 10", "8 0, 20 0, 20 10, 8 10", "0 20, 5 20, 5 30, 0 30"});
  ASSERT_EQ(found.faults.size(), 1u);
  EXPECT_EQ(found.faults[0].kind, FaultKind::overlap);
  EXPECT_THAT(found.faults[0].features, ElementsAre(0, 1));
}

TEST(CoverageFaults, AHoleOfOneFeatureIsNoGap) {
  EXPECT_THAT(faults_of({"0 0, 9 0, 9 9, 0 9; 3 3, 6 3, 6 6, 3 6", "9 0, 20 0, 20 9, 9 9"}).faults,
              IsEmpty());
}

// A position, the features that cover it, and whether noding may have moved an edge over it.
class Cover {
 public:
  Cover(double x, double y) : x_(x), y_(y) {}

  bool covers(const Rings& rings) {
    for (std::size_t r = 0; r < rings.size(); ++r) {
      const auto ring = rings[r];
      for (std::size_t i = 0; i < ring.size(); ++i) {
        note_distance(ring[i], ring[(i + 1) % ring.size()]);
      }
    }
    return is_inside(rings, x_, y_);
  }
  bool is_near() const { return least_ < 2; }

 private:
  void note_distance(Point a, Point b) {
    const double dx = static_cast<double>(b.x) - a.x;
    const double dy = static_cast<double>(b.y) - a.y;
    const double squared = dx * dx + dy * dy;
    const double along = squared == 0 ? 0 : ((x_ - a.x) * dx + (y_ - a.y) * dy) / squared;
    const double t = std::clamp(along, 0.0, 1.0);
    least_ = std::min(least_, std::hypot(x_ - a.x - t * dx, y_ - a.y - t * dy));
  }

  const double x_;
  const double y_;
  double least_ = 1e9;
};

TEST(CoverageFaults, OverlapsAreWhereSeveralFeaturesAreAndGapsWhereNoneIs) {
  std::size_t overlaps_seen = 0;
  std::size_t gaps_seen = 0;
  for (unsigned seed = 0; seed < 120; ++seed) {
    const std::vector<Rings> features = random_coverage(seed);
    const CoverageFaults found = find_faults(pointers_to(features));
    ASSERT_EQ(found.failure, "");
    Box box;
    for (const Rings& rings : features) {
      for (const Point p : rings.points) box.include(p);
    }
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> x(box.min_x, box.max_x);
    std::uniform_real_distribution<double> y(box.min_y, box.max_y);
    for (int i = 0; i < 200; ++i) {
      const double column = x(random);
      Cover place(column, y(random));
      std::vector<std::uint32_t> here;
      for (std::uint32_t f = 0; f < features.size(); ++f) {
        if (place.covers(features[f])) here.push_back(f);
      }
      if (place.is_near()) continue;
      std::vector<const CoverageFault*> faults;
      for (const CoverageFault& fault : found.faults) {
        if (place.covers(fault.polygons.rings)) faults.push_back(&fault);
      }
      SCOPED_TRACE(::testing::Message() << "seed " << seed << " sample " << i);
      if (here.size() == 1) {
        EXPECT_TRUE(faults.empty());
      } else if (here.size() > 1) {
        ++overlaps_seen;
        ASSERT_EQ(faults.size(), 1u);
        EXPECT_EQ(faults[0]->kind, FaultKind::overlap);
        EXPECT_EQ(faults[0]->features, here);
      } else if (!faults.empty()) {
        ++gaps_seen;
        ASSERT_EQ(faults.size(), 1u);
        EXPECT_EQ(faults[0]->kind, FaultKind::gap);
        EXPECT_GT(faults[0]->features.size(), 1u);
      }
    }
  }
  EXPECT_GT(overlaps_seen, 50u);
  EXPECT_GT(gaps_seen, 50u);
}

TEST(CoverageFaults, AreAsManyGapsAsTheCoverageHas) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const std::vector<Rings> features = random_coverage(seed);
    const CoverageFaults found = find_faults(pointers_to(features));
    for (const CoverageFault& fault : found.faults) EXPECT_FALSE(fault.polygons.empty()) << seed;
    if (count(found, FaultKind::overlap) > 0) continue;  // a gap may touch an overlap
    TrapezoidalGraph graph;
    CoverageBuilder builder;
    const CoverageOutcome outcome = builder.build(pointers_to(features), {}, graph);
    if (!outcome.built) continue;
    EXPECT_EQ(count(found, FaultKind::gap), outcome.gaps) << seed;
  }
}

TEST(CoverageFaults, OfPairsAddUpToTheirOverlaps) {
  for (unsigned seed = 0; seed < 200; seed += 4) {
    const std::vector<Rings> features = random_coverage(seed);
    const CoverageFaults found = find_faults(pointers_to(features));
    const double metre = cells_from_ground(1, 0);
    for (const Overlap& pair : overlay(pointers_to(features)).overlaps) {
      double sum = 0;
      for (const CoverageFault& fault : found.faults) {
        const std::set<std::uint32_t> those(fault.features.begin(), fault.features.end());
        const bool is_both = those.contains(pair.lower) && those.contains(pair.upper);
        if (fault.kind == FaultKind::overlap && is_both) sum += fault.area * metre * metre;
      }
      EXPECT_NEAR(sum, pair.area, 1e-4 * pair.area) << seed;
    }
  }
}

}  // namespace
}  // namespace trapeze
