#include "core/layer/earlier_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/borders/coverage_groups.h"
#include "core/grid/digest.h"
#include "core/layer/layer_builder.h"
#include "core/sweep/clean_rings.h"
#include "tests/core/shapes/maps.h"
#include "tests/core/shapes/same_layers.h"
#include "tests/core/shapes/shapes.h"
#include "tests/sanitized.h"

namespace trapeze {
namespace {

/// Makes one or a few changes.
void edit(std::mt19937& random, Map& map) {
  const auto below = [&random](std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
  };
  const std::size_t at = below(map.size());
  const auto place = map.begin() + static_cast<std::ptrdiff_t>(at);
  switch (below(7)) {
    case 0: {
      Rings& rings = map[at];
      if (!rings.points.empty()) rings.points[below(rings.points.size())].x += 7;
      break;
    }
    case 1:
      map.erase(place);
      break;
    case 2:
      map.insert(place, moved_by(random_shape(static_cast<unsigned>(below(1000))), {500, 300}));
      break;
    case 3:
      map.insert(place, Rings(map[below(map.size())]));
      break;
    case 4:
      std::swap(map[at], map[below(map.size())]);
      break;
    case 5:
      std::rotate(map.begin(), place, map.end());
      break;
    default:
      map[at] = moved_by(map[at], {13, -5});
  }
}

struct Built {
  std::shared_ptr<const Layer> layer;
  std::size_t taken_over = 0;
  std::string outcomes;  // of all features, built or taken over
};

std::string text_of(const BuildOutcome& outcome) {
  return std::to_string(outcome.built) + " " + std::to_string(outcome.noded) + " " +
         std::to_string(outcome.rings) + " " + std::to_string(outcome.collapsed_rings) + " " +
         std::to_string(outcome.vertices) + " " + outcome.failure + "\n";
}

std::string text_of(const Assembly& assembly) {
  const CoverageOutcome& outcome = assembly.outcome;
  std::string text = "group";
  for (const std::size_t count :
       {assembly.together.size(), assembly.apart.size(), std::size_t{outcome.built},
        std::size_t{outcome.noded}, outcome.vertices, outcome.shared_edges, outcome.junctions,
        outcome.gaps, outcome.filled, std::size_t{outcome.is_crowded}}) {
    text += " " + std::to_string(count);
  }
  for (const std::uint32_t i : assembly.apart) text += " -" + std::to_string(i);
  for (const Overlap& overlap : outcome.overlaps) {
    text += " (" + std::to_string(overlap.lower) + " " + std::to_string(overlap.upper) + " " +
            std::to_string(overlap.area) + " " + std::to_string(outcome.areas[overlap.lower]) + ")";
  }
  return text + outcome.failure + "\n";
}

/// The layer of a map by two builders, as loading a file of it would build it.
Built build(const Map& map, const LayerOptions& options, const Built* before = nullptr,
            unsigned threads = 1) {
  std::unique_ptr<EarlierLayer> earlier;
  if (before != nullptr) earlier = std::make_unique<EarlierLayer>(before->layer);
  std::vector<LayerBuilder> builders;
  for (int i = 0; i < 2; ++i) builders.emplace_back(options, nullptr, earlier.get());
  FeatureTable table(std::vector<Field>{});
  for (std::size_t i = 0; i < map.size(); ++i) table.append(static_cast<std::int64_t>(i), {});
  Map rings = map;
  std::vector<const Rings*> pointers;
  std::vector<bool> is_grouped(map.size(), false);
  Built built;
  const auto add = [&](std::uint32_t row) {
    built.outcomes += text_of(builders[row % 2].add(row, rings[row]));
  };
  if (options.coverage != CoverageMode::off) {
    for (Rings& feature : rings) {
      clean_rings(feature);
      pointers.push_back(&feature);
    }
    std::vector<std::uint32_t> known;
    if (earlier != nullptr) {
      std::vector<Digest> digests;
      for (const Rings& feature : rings) digests.push_back(digest_of(feature));
      known = earlier->known_groups(digests, true);
    }
    for (const auto& group : group_features(pointers, options.coverage, threads, known)) {
      std::vector<const Rings*> members;
      for (const std::uint32_t row : group) {
        members.push_back(pointers[row]);
        is_grouped[row] = true;
      }
      const Assembly assembly = builders[group.size() % 2].add_coverage(group, members);
      built.outcomes += text_of(assembly);
      for (const std::uint32_t i : assembly.apart) add(group[i]);
    }
  }
  for (std::uint32_t row = 0; row < map.size(); ++row) {
    if (!is_grouped[row] && !rings[row].empty()) add(row);
  }
  for (const LayerBuilder& builder : builders) built.taken_over += builder.taken_over();
  built.layer = LayerBuilder::join(builders, std::move(table), {}, threads);
  return built;
}

void expect_equal(const Built& one, const Built& other) {
  expect_same_layers(*one.layer, *other.layer);
  EXPECT_EQ(one.outcomes, other.outcomes);
}

std::vector<LayerOptions> all_options() {
  std::vector<LayerOptions> all(4);
  all[0].coverage = CoverageMode::off;
  all[1].coverage = CoverageMode::automatic;
  all[2].coverage = CoverageMode::on;
  all[3].weights = WeightRule::effective_area;
  return all;
}

TEST(EarlierLayerTest, WhatIsTakenOverIsAsIfItWereBuilt) {
  for (const LayerOptions& options : all_options()) {
    for (unsigned seed = 0; seed < (testing::kIsSanitized ? 3 : 12); ++seed) {
      SCOPED_TRACE("coverage " + std::string(kCoverageNames.name_of(options.coverage)) + ", seed " +
                   std::to_string(seed));
      std::mt19937 random(seed);
      Map map = sample_map(seed);
      Built before = build(map, options);
      // Each layer takes over from one that took over itself.
      for (int step = 0; step < 6; ++step) {
        SCOPED_TRACE("step " + std::to_string(step));
        for (int changes = 0; changes <= step % 3; ++changes) edit(random, map);
        Built after = build(map, options, &before, 1 + seed % 2);
        expect_equal(build(map, options), after);
        if (::testing::Test::HasFailure()) return;
        before = std::move(after);
      }
    }
  }
}

TEST(EarlierLayerTest, TakesOverAllThatHasNotChanged) {
  LayerOptions options;
  Map map = sample_map(1);
  options.coverage = CoverageMode::off;
  const Built before = build(map, options);
  EXPECT_EQ(build(map, options, &before).taken_over, before.layer->features().size());
  map[2].points[0].x += 1;
  EXPECT_EQ(build(map, options, &before).taken_over, before.layer->features().size() - 1);
}

TEST(EarlierLayerTest, AGroupIsBuiltAnewIfOneOfItsFeaturesHasChanged) {
  std::mt19937 random(5);
  Map map;
  add_block(random, {0, 0}, 3, map);
  add_block(random, {10000, 0}, 2, map);
  const Built before = build(map, {});
  EXPECT_EQ(before.layer->features().size(), 13u);
  EXPECT_EQ(build(map, {}, &before).taken_over, 13u);
  map.back().points[2].x += 9;
  EXPECT_EQ(build(map, {}, &before).taken_over, 9u);
  std::swap(map[0], map[1]);  // changes which one overlaps the other
  EXPECT_EQ(build(map, {}, &before).taken_over, 0u);
}

TEST(EarlierLayerTest, FeaturesThatHaveChangedPlacesAreTakenOver) {
  LayerOptions options;
  options.coverage = CoverageMode::off;
  for (unsigned seed = 0; seed < 8; ++seed) {
    Map map = sample_map(seed);
    const Built before = build(map, options);
    std::shuffle(map.begin(), map.end(), std::mt19937(seed));
    const Built after = build(map, options, &before);
    EXPECT_EQ(after.taken_over, build(map, options).layer->features().size());
    expect_equal(build(map, options), after);
  }
}

TEST(EarlierLayerTest, EachOfManyEqualFeaturesIsTakenOverOnce) {
  LayerOptions options;
  options.coverage = CoverageMode::off;
  const Map three(3, random_shape(4));
  const Map five(5, random_shape(4));
  const Built before = build(three, options);
  const Built after = build(five, options, &before);
  EXPECT_EQ(after.taken_over, 3u);
  expect_equal(build(five, options), after);
  const Built less = build({three[0]}, options, &after);
  EXPECT_EQ(less.taken_over, 1u);
  expect_equal(build({three[0]}, options), less);
}

TEST(EarlierLayerTest, WhatDidNotKnowAllOverlapsIsNoSourceOfThem) {
  LayerOptions options;
  options.coverage = CoverageMode::off;
  const Map many(2100, random_shape(4));
  const Map few(many.begin(), many.begin() + 20);
  const Built before = build(many, options);
  ASSERT_FALSE(before.layer->has_all_overlaps());
  const Built after = build(few, options, &before);
  EXPECT_EQ(after.taken_over, 20u);
  EXPECT_TRUE(after.layer->has_all_overlaps());
  EXPECT_EQ(after.layer->overlaps().pairs().size(), 20u * 19);
}

/// Sectors around one vertex, too many for one graph if there are 4,500 of them.
Map sectors(int count) {
  const auto on_circle = [](int i) {
    const double angle = 2 * std::numbers::pi * i / 4500;
    return Point{static_cast<std::int32_t>(std::lround(1e6 * std::cos(angle))),
                 static_cast<std::int32_t>(std::lround(1e6 * std::sin(angle)))};
  };
  Map map(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    map[static_cast<std::size_t>(i)].add(
        std::vector<Point>{{0, 0}, on_circle(i), on_circle(i + 1)});
  }
  return map;
}

TEST(EarlierLayerTest, FeaturesOfAGroupThatFailedAreStillOneGroup) {
  const Built before = build(sectors(4500), {});
  ASSERT_NE(before.outcomes.find("borders meet at one vertex"), std::string::npos);
  expect_equal(before, build(sectors(4500), {}, &before));
  const Built fewer = build(sectors(500), {});
  ASSERT_EQ(fewer.outcomes.find("borders meet at one vertex"), std::string::npos);
  expect_equal(fewer, build(sectors(500), {}, &before));
}

TEST(EarlierLayerTest, ThereAreNoMoreOverlapsThanIfNothingWereTakenOver) {
  LayerOptions options;
  options.coverage = CoverageMode::off;
  const auto squares = [](std::int32_t count) {
    Map map(static_cast<std::size_t>(count));
    for (std::int32_t i = 0; i < count; ++i) {
      const std::int32_t side = 10'000 + i;
      map[static_cast<std::size_t>(i)].add(
          std::vector<Point>{{0, 0}, {side, 0}, {side, 10'000}, {0, 10'000}});
    }
    return map;
  };
  const Built before = build(squares(1010), options);
  ASSERT_TRUE(before.layer->has_all_overlaps());
  const Built anew = build(squares(1060), options);
  ASSERT_FALSE(anew.layer->has_all_overlaps());
  expect_equal(anew, build(squares(1060), options, &before));
}

TEST(EarlierLayerTest, NothingLeftOrNothingBeforeIsNoSpecialCase) {
  const Built nothing = build({}, {});
  const Map map = sample_map(2);
  const Built something = build(map, {}, &nothing);
  expect_equal(build(map, {}), something);
  expect_equal(nothing, build({}, {}, &something));
}

TEST(DigestTest, TellsRingsApart) {
  const auto digest = [](const std::vector<std::vector<Point>>& rings) {
    Rings all;
    for (const auto& ring : rings) all.add(ring);
    return digest_of(all);
  };
  const Point a{1, 2};
  const Point b{3, 4};
  const Point c{5, 6};
  const Point d{7, 8};
  EXPECT_EQ(digest({{a, b, c}}), digest({{a, b, c}}));
  EXPECT_NE(digest({{a, b, c}}), digest({{a, c, b}})) << "the order of points";
  EXPECT_NE(digest({{a, b, c}}), digest({{b, c, a}})) << "where a ring begins";
  EXPECT_NE(digest({{a, b}, {c, d}}), digest({{c, d}, {a, b}})) << "the order of rings";
  EXPECT_NE(digest({{a, b, c}, {d}}), digest({{a, b}, {c, d}})) << "where rings end";
  EXPECT_NE(digest({{{1, 2}}}), digest({{{2, 1}}}));
  EXPECT_NE(digest({{{-1, 0}}}), digest({{{0, -1}}}));
  Rings one;
  one.add(std::vector<Point>{a, b, c});
  const Digest of_one = digest_of(one);
  EXPECT_NE(of_one, digest_of(std::span(&of_one, 1))) << "a group of one feature";
}

TEST(DigestTest, DependsOnEveryBit) {
  const auto digest = [](std::vector<std::uint64_t> words) {
    Digester digester;
    for (const std::uint64_t word : words) digester.add(word);
    return digester.digest();
  };
  std::vector<Digest> all = {digest({}), digest({0}), digest({0, 0}), digest({0, 0, 0})};
  for (std::size_t word = 0; word < 3; ++word) {
    for (int bit = 0; bit < 64; ++bit) {
      std::vector<std::uint64_t> words(3, 0);
      words[word] = std::uint64_t{1} << bit;
      all.push_back(digest(words));
    }
  }
  std::ranges::sort(all);
  EXPECT_EQ(std::ranges::adjacent_find(all), all.end());
}

}  // namespace
}  // namespace trapeze
