#include "core/borders/coverage_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "core/graph/check_graph.h"
#include "core/layer/layer_builder.h"
#include "core/layer/untested_layer.h"
#include "tests/core/borders/coverage_shapes.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Features {
 public:
  explicit Features(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) rings_.push_back(rings_from_text(text));
    point_at_rings();
  }
  static Features of(std::vector<Rings> rings) {
    Features features(std::vector<std::string>{});
    features.rings_ = std::move(rings);
    features.point_at_rings();
    return features;
  }

  std::vector<std::vector<std::uint32_t>> groups(CoverageMode coverage) const {
    return group_features(pointers_, coverage);
  }
  std::vector<std::vector<std::uint32_t>> groups_for_blocks() const {
    return group_for_blocks(pointers_);
  }
  Assembly assembly(CoverageMode coverage) {
    CoverageBuilder builder;
    return assemble(pointers_, coverage, 0, builder, graph);
  }

  TrapezoidalGraph graph;

 private:
  void point_at_rings() {
    for (const Rings& rings : rings_) pointers_.push_back(&rings);
  }

  std::vector<Rings> rings_;
  std::vector<const Rings*> pointers_;
};

constexpr const char* kLeft10 = "0 0, 10 0, 10 10, 0 10";
constexpr const char* kRight10 = "10 0, 20 0, 20 10, 10 10";

std::string rectangle(int x, int y, int width, int height) {
  const std::string left = std::to_string(x) + " ";
  const std::string right = std::to_string(x + width) + " ";
  const std::string top = std::to_string(y);
  const std::string bottom = std::to_string(y + height);
  return left + top + ", " + right + top + ", " + right + bottom + ", " + left + bottom;
}

TEST(CoverageGroups, ModesAreFoundByTheirNames) {
  for (const CoverageMode mode : {CoverageMode::off, CoverageMode::automatic, CoverageMode::on}) {
    EXPECT_EQ(kCoverageNames.find(kCoverageNames.name_of(mode)), mode);
  }
  EXPECT_EQ(kCoverageNames.find("automatic"), std::nullopt);
}

TEST(CoverageGroups, AnEdgeInCommonTiesWhateverItsDirection) {
  EXPECT_THAT(Features({kLeft10, kRight10}).groups(CoverageMode::automatic),
              ElementsAre(ElementsAre(0, 1)));
  EXPECT_THAT(Features({kLeft10, "20 10, 20 0, 10 0, 10 10"}).groups(CoverageMode::automatic),
              ElementsAre(ElementsAre(0, 1)));
}

TEST(CoverageGroups, WhatMayBecomeOneBlockIsInOneGroup) {
  const auto house = [](int x) { return rectangle(x, 0, 100, 100); };
  const int far = 100'000;
  EXPECT_THAT(
      Features({house(0), house(far), house(10'000), house(far + 16'000)}).groups_for_blocks(),
      ElementsAre(ElementsAre(0, 2), ElementsAre(1, 3)));
  EXPECT_THAT(Features({house(0), house(far), house(1000), house(2 * far)}).groups_for_blocks(),
              ElementsAre(ElementsAre(0, 2), ElementsAre(1, 3)))
      << "those that are near no other are together";
  EXPECT_THAT(Features({house(far), house(0), house(1000)}).groups_for_blocks(),
              ElementsAre(ElementsAre(0, 1, 2)))
      << "none is by itself";
  EXPECT_THAT(Features({house(0)}).groups_for_blocks(), IsEmpty());
  EXPECT_THAT(Features(std::vector<std::string>{}).groups_for_blocks(), IsEmpty());
}

TEST(CoverageGroups, WhatOnlyTouchesIsTiedIfAskedFor) {
  const Features features({kLeft10, "10 10, 20 10, 20 20, 10 20", "40 0, 50 0, 50 10, 40 10"});
  EXPECT_THAT(features.groups(CoverageMode::automatic), IsEmpty());
  EXPECT_THAT(features.groups(CoverageMode::on), ElementsAre(ElementsAre(0, 1)));
}

TEST(CoverageGroups, TiesReachFromNeighbourToNeighbour) {
  const Features features({"20 0, 30 0, 30 10, 20 10", kLeft10, "90 0, 95 0, 95 5", kRight10});
  EXPECT_THAT(features.groups(CoverageMode::automatic), ElementsAre(ElementsAre(0, 1, 3)));
}

TEST(CoverageGroups, WhatOverlapsByTooMuchStaysApart) {
  // A building on the right square, with which it shares an edge.
  Features features({kLeft10, kRight10, "20 0, 20 10, 12 10, 12 0"});
  const Assembly assembly = features.assembly(CoverageMode::automatic);
  EXPECT_THAT(assembly.together, ElementsAre(0, 1));
  EXPECT_THAT(assembly.apart, ElementsAre(2));
  EXPECT_EQ(check_graph(features.graph), "");
  const Assembly all = features.assembly(CoverageMode::on);
  EXPECT_THAT(all.together, ElementsAre(0, 1, 2));
  EXPECT_THAT(all.apart, IsEmpty());
  EXPECT_EQ(all.outcome.overlaps.size(), 1u);
}

TEST(CoverageGroups, TheOneWithTheFewestNeighboursIsLeftOut) {
  // A field under two plots, which are neighbours.
  Features features({"0 0, 20 0, 20 10, 0 10", kLeft10, kRight10});
  const Assembly assembly = features.assembly(CoverageMode::automatic);
  EXPECT_THAT(assembly.together, ElementsAre(1, 2));
  EXPECT_THAT(assembly.apart, ElementsAre(0));
}

TEST(CoverageGroups, WhatIsThereTwiceDoesNotCostTheMotherland) {
  // The left feature has two islands, which are also features of their own.
  Features features({"0 0, 10 0, 10 10, 0 10; 50 0, 55 0, 55 5; 60 0, 65 0, 65 5", kRight10,
                     "50 0, 55 0, 55 5", "60 0, 65 0, 65 5"});
  const Assembly assembly = features.assembly(CoverageMode::automatic);
  EXPECT_THAT(assembly.together, ElementsAre(0, 1));
  EXPECT_THAT(assembly.apart, ElementsAre(2, 3));
}

TEST(CoverageGroups, ALittleOverlapIsNoReason) {
  Features features(
      {"0 0, 1000 0, 1001 500, 1000 1000, 0 1000", "1000 0, 2000 0, 2000 1000, 1000 1000"});
  const Assembly assembly = features.assembly(CoverageMode::automatic);
  EXPECT_THAT(assembly.together, ElementsAre(0, 1));
  EXPECT_EQ(assembly.outcome.overlaps.size(), 1u);
}

TEST(CoverageGroups, ParcelsThatAreThereTwiceCostOneOfEachPair) {
  constexpr int kColumns = 60;
  std::vector<std::string> texts;
  for (int i = 0; i < 2 * kColumns * kColumns; ++i) {
    texts.push_back(rectangle(i % kColumns * 10, i / kColumns % kColumns * 10, 10, 10));
  }
  Features features(texts);
  const Assembly assembly = features.assembly(CoverageMode::automatic);
  EXPECT_EQ(assembly.together.size(), std::size_t{kColumns * kColumns});
  EXPECT_EQ(assembly.apart.size(), std::size_t{kColumns * kColumns});
  EXPECT_EQ(assembly.outcome.shared_edges, std::size_t{2 * kColumns * (kColumns - 1)});
}

TEST(CoverageGroups, OverlapsOfAHeapOfFeaturesAreExact) {
  // Rectangles from one corner, each overlapping all the others, so that i and k overlap by the
  // smaller height and the smaller width of the two.
  constexpr int kCount = 120;
  std::vector<std::string> texts;
  for (int i = 0; i < kCount; ++i) {
    texts.push_back(rectangle(0, 0, 10 + i, 10 + kCount - i));
  }
  Features features(texts);
  const Assembly assembly = features.assembly(CoverageMode::on);
  ASSERT_EQ(assembly.outcome.overlaps.size(), std::size_t{kCount * (kCount - 1) / 2});
  for (const Overlap& overlap : assembly.outcome.overlaps) {
    EXPECT_EQ(overlap.area, (10.0 + overlap.lower) * (10.0 + kCount - overlap.upper));
  }
}

TEST(CoverageGroups, TooManyOverEachOtherStayApartInWords) {
  const std::vector<std::string> texts(6000, kLeft10);
  Features features(texts);
  for (const CoverageMode mode : {CoverageMode::on, CoverageMode::automatic}) {
    const Assembly assembly = features.assembly(mode);
    EXPECT_FALSE(assembly.outcome.built);
    EXPECT_EQ(assembly.outcome.failure, "too many of them overlap");
    EXPECT_EQ(assembly.apart.size(), texts.size());
  }
}

TEST(CoverageGroups, TooManyWithinEachOtherStayApartInWords) {
  // Nested squares: each feature overlaps all the smaller ones.
  std::vector<std::string> texts;
  for (int i = 1; i <= 4200; ++i) texts.push_back(rectangle(-i, -i, 2 * i, 2 * i));
  const Assembly assembly = Features(texts).assembly(CoverageMode::on);
  EXPECT_EQ(assembly.outcome.failure, "too many of them overlap");
  EXPECT_EQ(assembly.apart.size(), texts.size());
}

/// A comb with teeth to the right or, if turned, downwards.
Rings comb(std::int32_t teeth, bool is_turned) {
  Rings rings;
  const std::int32_t length = 20 * teeth;
  rings.points.push_back({-10, 20 * teeth});
  rings.points.push_back({-10, 0});
  for (std::int32_t i = 0; i < teeth; ++i) {
    rings.points.push_back({length, 20 * i + 5});
    rings.points.push_back({0, 20 * i + 10});
  }
  rings.close_ring();
  if (is_turned) {
    for (Point& p : rings.points) std::swap(p.x, p.y);
  }
  return rings;
}

TEST(CoverageGroups, WhatCrossesTooOftenStaysApartInWords) {
  const Assembly few = Features::of({comb(50, false), comb(50, true)}).assembly(CoverageMode::on);
  EXPECT_EQ(few.outcome.failure, "");
  EXPECT_EQ(few.together.size(), 2u);
  const Assembly many =
      Features::of({comb(300, false), comb(300, true)}).assembly(CoverageMode::on);
  EXPECT_EQ(many.outcome.failure, "their borders cross more than 262144 times");
  EXPECT_EQ(many.apart.size(), 2u);
}

/// Sectors of a circle that meet at its centre.
std::vector<Rings> sectors(int count) {
  const auto at = [count](int i) {
    const double angle = 2 * std::numbers::pi * i / count;
    return Point{static_cast<std::int32_t>(std::lround(1e7 * std::cos(angle))),
                 static_cast<std::int32_t>(std::lround(1e7 * std::sin(angle)))};
  };
  std::vector<Rings> features(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    features[static_cast<std::size_t>(i)].add(
        std::vector<Point>{{0, 0}, at(i), at(i + 1 < count ? i + 1 : 0)});
  }
  return features;
}

TEST(CoverageGroups, TooManyAroundOneVertexStayApartInWords) {
  const Assembly few = Features::of(sectors(400)).assembly(CoverageMode::automatic);
  EXPECT_EQ(few.outcome.failure, "");
  EXPECT_EQ(few.together.size(), 400u);
  const Assembly many = Features::of(sectors(5000)).assembly(CoverageMode::automatic);
  EXPECT_EQ(many.outcome.failure, "up to 5000 borders meet at one vertex");
  EXPECT_EQ(many.apart.size(), 5000u);
}

TEST(CoverageGroups, OneThatIsLeftAloneIsNoCoverage) {
  Features features({kLeft10, kLeft10});
  const Assembly assembly = features.assembly(CoverageMode::automatic);
  EXPECT_THAT(assembly.together, IsEmpty());
  EXPECT_THAT(assembly.apart, ElementsAre(0, 1));
}

/// Stars that overlap each other by the dozen everywhere.
std::vector<Rings> crowd() {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int32_t> place(-1'000'000, 1'000'000);
  std::vector<Rings> features(300);
  for (Rings& rings : features) {
    const Point middle{place(random), place(random)};
    rings.add(random_star(random, middle, 10, 300'000, 600'000));
    clean_rings(rings);
  }
  return features;
}

std::vector<Rings> squares(std::size_t count) {
  return std::vector<Rings>(count, rings_from_text("0 0, 1000 0, 1000 1000, 0 1000"));
}

TEST(CoverageGroups, OfACrowdOnlyThoseThatOverlapStayApart) {
  std::vector<Rings> rings = crowd();
  rings.push_back(rings_from_text("2000000 0, 3000000 0, 3000000 1000000, 2000000 1000000"));
  rings.push_back(rings_from_text("3000000 0, 4000000 0, 4000000 1000000, 3000000 1000000"));
  const Assembly assembly = Features::of(rings).assembly(CoverageMode::on);
  EXPECT_TRUE(assembly.outcome.is_crowded);
  EXPECT_EQ(assembly.outcome.failure, "");
  EXPECT_GT(assembly.apart.size(), 250u);
  EXPECT_THAT(assembly.together, ::testing::IsSupersetOf({300u, 301u}));
}

TEST(CoverageGroups, ACrowdOfNothingElseIsNoCoverage) {
  const Assembly few = Features::of(squares(64)).assembly(CoverageMode::on);
  EXPECT_FALSE(few.outcome.is_crowded);
  EXPECT_EQ(few.together.size(), 64u);
  const Assembly many = Features::of(squares(65)).assembly(CoverageMode::on);
  EXPECT_TRUE(many.outcome.is_crowded);
  EXPECT_EQ(many.apart.size(), 65u);
}

TEST(CoverageGroups, ACrowdLeavesOverlapsElsewhereTogether) {
  std::vector<Rings> rings = squares(65);
  rings.push_back(rings_from_text("500000 0, 501000 0, 501000 1000, 500000 1000"));
  rings.push_back(rings_from_text("500500 500, 501500 500, 501500 1500, 500500 1500"));
  const Assembly assembly = Features::of(rings).assembly(CoverageMode::on);
  EXPECT_TRUE(assembly.outcome.is_crowded);
  EXPECT_EQ(assembly.apart.size(), 64u);
  EXPECT_THAT(assembly.together, ElementsAre(0, 65, 66));
}

/// A coverage layer with all features in one group.
std::unique_ptr<Layer> layer_of(const std::vector<Rings>& features) {
  LayerOptions options;
  options.coverage = CoverageMode::on;
  std::vector<LayerBuilder> builders;
  builders.emplace_back(options);
  FeatureTable table(std::vector<Field>{});
  std::vector<std::uint32_t> rows;
  std::vector<const Rings*> rings;
  for (const Rings& feature : features) {
    rows.push_back(table.append(static_cast<std::int64_t>(rows.size()), {}));
    rings.push_back(&feature);
  }
  builders.front().add_coverage(rows, rings);
  return LayerBuilder::join(builders, std::move(table));
}

/// Twice the area between the edges of trapezoids and dust boxes, signed.
double area_of(const MeshView& mesh, std::span<const TrapezoidRange> ranges) {
  double area = 0;
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    const MeshTrapezoid& t = mesh.trapezoids[i];
    const double top = mesh.vertices[t.top].y;
    const double bottom = mesh.vertices[t.bottom].y;
    if (top == bottom) return;
    const auto x_at = [&](std::uint32_t edge, double y) {
      const Point u = mesh.vertices[mesh.edges[edge].upper];
      const Point l = mesh.vertices[mesh.edges[edge].lower];
      return u.x +
             (static_cast<double>(l.x) - u.x) * ((y - u.y) / (static_cast<double>(l.y) - u.y));
    };
    const double middle = (top + bottom) / 2;
    area += (bottom - top) * (x_at(t.right, middle) - x_at(t.left, middle));
  });
  return area;
}

TEST(CoverageLayer, BorderIsStoredOnceAndLeadsToBothFeatures) {
  const auto layer = layer_of({rings_from_text(kLeft10), rings_from_text(kRight10)});
  std::vector<TrapezoidRange> ranges;
  layer->select({layer->bounds(), 0}, ranges);
  const MeshView& mesh = layer->mesh();
  std::vector<std::uint32_t> right_of_first;
  std::vector<std::uint32_t> left_of_second;
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    if (layer->feature_of(i) == 0) right_of_first.push_back(mesh.trapezoids[i].right);
    if (layer->feature_of(i) == 1) left_of_second.push_back(mesh.trapezoids[i].left);
  });
  ASSERT_FALSE(right_of_first.empty());
  EXPECT_EQ(right_of_first, left_of_second);
  for (std::uint32_t row = 0; row < 2; ++row) {
    Rings outline;
    layer->append_outline(row, outline);
    ASSERT_EQ(outline.size(), 1u);
    EXPECT_EQ(doubled_area_of(outline[0]), 200);
  }
}

TEST(CoverageLayer, ACrowdTakesNoMoreThanItsVerticesDo) {
  std::vector<Rings> features = crowd();
  LayerOptions options;
  options.coverage = CoverageMode::on;
  std::vector<LayerBuilder> builders;
  builders.emplace_back(options);
  std::vector<std::uint32_t> rows;
  std::vector<const Rings*> rings;
  std::size_t vertices = 0;
  for (const Rings& feature : features) {
    rows.push_back(static_cast<std::uint32_t>(rows.size()));
    rings.push_back(&feature);
    vertices += feature.points.size();
  }
  for (const std::uint32_t i : builders.front().add_coverage(rows, rings).apart) {
    builders.front().add(rows[i], features[i]);
  }
  const auto layer = LayerBuilder::join(builders, FeatureTable());
  EXPECT_LT(layer->size().trapezoids, 4 * vertices);
  EXPECT_FALSE(layer->overlaps().empty());
}

TEST(CoverageLayer, DustOfAllFeaturesTogetherMakesUpForWhatIsDrawn) {
  for (unsigned seed = 1; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto layer = layer_of(random_coverage(seed));
    if (layer->bounds().is_empty()) continue;
    constexpr Box kWorld{kGridMin, kGridMin, kGridMax, kGridMax};
    std::vector<TrapezoidRange> ranges;
    layer->select({kWorld, 0, kLastLevel, SmallPolygons::drop}, ranges);
    std::vector<double> areas(layer->features().size(), 0);
    for_each_trapezoid(ranges, [&](std::uint32_t i) {
      const TrapezoidRange one{i, 1};
      areas[layer->feature_of(i)] += area_of(layer->mesh(), std::span(&one, 1));
    });
    // At the last level nothing is drawn, and the dust of each feature equals its original area.
    std::vector<double> dust(areas.size(), 0);
    layer->grains().visit(kWorld, GrainIndex::Births{}, [&](const FeatureGrain& grain) {
      dust[grain.row] += static_cast<double>(grain.doubled_area) / 2;
    });
    const double grains = static_cast<double>(layer->grains().grains().size());
    for (std::size_t row = 0; row < areas.size(); ++row) {
      EXPECT_NEAR(dust[row], areas[row], 1 + grains / 2) << "row " << row;
    }
  }
}

TEST(CoverageLayer, WithoutTheTestItIsItsPolygonsApart) {
  const auto layer = layer_of({rings_from_text(kLeft10), rings_from_text(kRight10)});
  const auto fast = build_without_topology_test(*layer);
  std::vector<TrapezoidRange> ranges;
  fast->select({layer->bounds(), 0}, ranges);
  EXPECT_DOUBLE_EQ(area_of(fast->mesh(), ranges), 200);
}

}  // namespace
}  // namespace trapeze
