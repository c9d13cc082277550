#include "server/tiles/layer_style.h"

#include <gmock/gmock.h>

#include <chrono>
#include <random>
#include <thread>

#include "core/layer/layer_builder.h"
#include "server/documents/legend.h"
#include "tests/sanitized.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr Rgba kRed{255, 0, 0, 255};
constexpr Rgba kBlue{0, 0, 255, 255};
constexpr Rgba kLime{0, 255, 0, 255};

/// A layer "towns" with four features, ids 10 to 13, and no polygons.
ServedLayer towns(const LayerOptions& options = {}) {
  FeatureTable features(
      {{"kind", FieldType::text}, {"people", FieldType::integer}, {"height", FieldType::real}});
  const auto add = [&features](std::vector<Value> values) {
    features.append(10 + static_cast<std::int64_t>(features.size()), values);
  };
  add({"city", std::int64_t{500}, 1.5});
  add({"village", std::int64_t{20}, -3.0});
  add({"a,b:c", std::int64_t{100}, Value()});
  add({Value(), Value(), 2.5});
  std::vector<LayerBuilder> builders;
  builders.emplace_back(options);
  ServedLayer served;
  served.config.name = "towns";
  served.config.style = testing::style_of("fill=lime");
  served.layer = LayerBuilder::join(builders, std::move(features));
  return served;
}

class LayerStyleTest : public ::testing::Test {
 protected:
  Result<LayerStyle> resolve(std::string_view query) {
    const std::vector<std::string> layers = {"towns", "lakes"};
    const auto parsed = StyleQuery::parse(decode_query(query).value(), layers);
    if (!parsed) return parsed.problem();
    const auto complete = complete_style(*parsed, served_.config);
    return complete ? layer_style(*complete, served_, 0) : complete.problem();
  }
  LayerStyle style(std::string_view query) {
    auto resolved = resolve(query);
    if (!resolved) {
      ADD_FAILURE() << query << ": " << resolved.problem().detail;
      return {};
    }
    return *std::move(resolved);
  }
  double tolerance(std::string_view query) {
    const std::vector<std::string> layers = {"towns", "lakes"};
    const auto parsed = StyleQuery::parse(decode_query(query).value(), layers);
    return parsed ? tolerance_in_pixels(*parsed, served_) : -1;
  }
  Problem problem(std::string_view query) {
    auto resolved = resolve(query);
    if (!resolved) return std::move(resolved).problem();
    ADD_FAILURE() << query << " was taken";
    return {0, ""};
  }
  FeatureClasses classes(std::string_view query) {
    return classify(style(query).classing, served_.layer->features());
  }

  ServedLayer served_ = towns();
};

TEST_F(LayerStyleTest, WithoutAnythingItIsTheLayersOwnFill) {
  const LayerStyle plain = style("");
  EXPECT_THAT(plain.paints, ElementsAre(::testing::Field(&ClassPaint::fill, kLime)));
  EXPECT_TRUE(plain.classing.is_plain());
  EXPECT_EQ(plain.stroke.width, 0);
  EXPECT_EQ(plain.pattern.kind, PatternKind::none);
  EXPECT_EQ(plain.opacity, 1);
}

TEST_F(LayerStyleTest, OutlinesAndPatternsHaveTheirDefaults) {
  const LayerStyle red = style("stroke=red&stroke-opacity=0.5");
  EXPECT_EQ(red.stroke.width, 1);
  EXPECT_EQ(red.paints[0].stroke, (Rgba{255, 0, 0, 128}));
  EXPECT_EQ(style("stroke-width=2.5").stroke.width, 2.5);
  EXPECT_EQ(style("stroke-width=2.5").paints[0].stroke, (Rgba{0, 0, 0, 255}));
  EXPECT_EQ(style("stroke-dasharray=1,2,3&stroke=red").stroke.dashes,
            (std::vector<double>{1, 2, 3, 1, 2, 3}));
  EXPECT_EQ(style("stroke-linejoin=miter&stroke=red").stroke.join, LineJoin::miter);
  const Pattern hatch = style("pattern=hatch").pattern;
  EXPECT_EQ(hatch.kind, PatternKind::hatch);
  EXPECT_EQ(hatch.angle, 45);
  EXPECT_EQ(style("pattern=stripes&pattern-size=12").pattern.width, 6);
  EXPECT_EQ(style("pattern=checker&pattern-angle=-90").pattern.angle, 270);
  EXPECT_EQ(style("pattern=none&pattern-size=12").pattern, Pattern());
}

TEST_F(LayerStyleTest, BlocksAreDrawnAtTheToleranceAtWhichTheyAre) {
  LayerOptions options;
  options.merge = 4;
  served_ = towns(options);
  EXPECT_EQ(tolerance(""), kTolerancePixels);
  EXPECT_EQ(tolerance("merge=4"), kTolerancePixels);
  EXPECT_EQ(tolerance("merge=10"), 2.5 * kTolerancePixels);
  EXPECT_EQ(tolerance("merge=0"), 0);
  EXPECT_EQ(tolerance("merge=8&simplify=3"), 2 * kTolerancePixels);
  EXPECT_EQ(tolerance("towns.merge=8&merge=4"), 2 * kTolerancePixels);
  EXPECT_EQ(tolerance("lakes.merge=8"), kTolerancePixels);
  EXPECT_TRUE(resolve("merge=64"));
}

TEST_F(LayerStyleTest, OnlyALayerThatIsMergedHasBlocks) {
  const Problem refused = problem("merge=8");
  EXPECT_EQ(refused.status, 400);
  EXPECT_EQ(refused.parameter, "merge");
  EXPECT_THAT(refused.detail, HasSubstr("layer towns is not merged into blocks"));
  EXPECT_THAT(refused.detail, HasSubstr("--merge 4"));
  EXPECT_TRUE(resolve("merge=0"));
  EXPECT_TRUE(resolve("lakes.merge=8"));
  LayerOptions options;
  options.merge = 0.125;
  served_ = towns(options);
  EXPECT_TRUE(resolve("merge=32"));
  EXPECT_THAT(problem("merge=33").takes, HasSubstr("at most 32"));
}

TEST_F(LayerStyleTest, ClassesByValue) {
  const std::string query = "color-by=kind&classes=city:red,'a,b:c':blue,null:white,*:rgb(1,2,3)";
  EXPECT_THAT(classes(query), ElementsAre(0, 3, 1, 2));
  const LayerStyle resolved = style(query);
  ASSERT_EQ(resolved.paints.size(), 4u);
  EXPECT_EQ(resolved.paints[0].fill, kRed);
  EXPECT_EQ(resolved.paints[1].fill, kBlue);
  EXPECT_EQ(resolved.paint_of_others().fill, (Rgba{1, 2, 3, 255}));
  EXPECT_EQ(style("color-by=kind&classes=city:red").paint_of_others().fill, kLime);
  EXPECT_EQ(style(query + "&fill-opacity=0.5").paints[0].fill, (Rgba{255, 0, 0, 128}));
  EXPECT_THAT(classes("color-by=people&classes=20:red,500:blue"), ElementsAre(1, 0, 2, 2));
  EXPECT_THAT(classes("color-by=height&classes=1.50:red,null:blue"), ElementsAre(0, 2, 1, 2));
}

TEST_F(LayerStyleTest, ClassesByBreaks) {
  const std::string query = "color-by=people&breaks=100,500&ramp=blues";
  EXPECT_THAT(classes(query), ElementsAre(2, 0, 1, 3)) << "a break belongs to the class above it";
  const LayerStyle resolved = style(query);
  ASSERT_EQ(resolved.paints.size(), 4u);
  EXPECT_EQ(to_hex(resolved.paints[2].fill), "3182bdff");
  EXPECT_EQ(resolved.paint_of_others().fill, kLime);
  EXPECT_EQ(to_hex(style("color-by=people&breaks=100,500&ramp=Blues-r").paints[0].fill),
            "3182bdff");
}

TEST_F(LayerStyleTest, FiltersIdsAndHighlights) {
  EXPECT_THAT(classes("filter=people+>+50"), ElementsAre(0, kNotDrawn, 0, kNotDrawn));
  EXPECT_THAT(classes("ids=13,10"), ElementsAre(0, kNotDrawn, kNotDrawn, 0));
  EXPECT_THAT(classes("highlight=11&ids=10,11"), ElementsAre(0, 1, kNotDrawn, kNotDrawn));
  EXPECT_THAT(classes("highlight=11,99&color-by=kind&classes=city:red"), ElementsAre(0, 2, 1, 1));
  const LayerStyle resolved = style("highlight=11&highlight-fill=blue&stroke=red");
  ASSERT_EQ(resolved.paints.size(), 2u);
  EXPECT_EQ(resolved.paints[1], (ClassPaint{kBlue, kRed}));
  EXPECT_EQ(style("highlight=11&highlight-stroke=blue").paints[1].stroke, kBlue);
}

TEST_F(LayerStyleTest, WhatDoesNotFitTheLayerOrItselfIsAProblem) {
  const std::vector<std::array<std::string, 3>> wrong = {
      {"color-by=nosuch&classes=1:red", "color-by", "kind, people, height"},
      {"filter=nosuch=1", "filter", "kind, people, height"},
      {"filter=kind=1", "filter", "single quotes"},
      {"color-by=kind", "color-by", "classes"},
      {"classes=1:red", "classes", "color-by"},
      {"breaks=1&ramp=Blues", "breaks", "color-by"},
      {"color-by=people&breaks=1", "breaks", "ramp"},
      {"color-by=people&ramp=Blues", "ramp", "breaks"},
      {"color-by=people&classes=1:red&breaks=1&ramp=Blues", "classes", "no breaks"},
      {"color-by=kind&breaks=1&ramp=Blues", "color-by", "numeric"},
      {"color-by=people&classes=x:red", "classes", "integers"},
      {"color-by=people&classes=1.5:red", "classes", "integers"},
      {"color-by=height&classes=x:red", "classes", "numbers"},
      {"color-by=people&breaks=1,2,3,4,5,6,7,8,9&ramp=Set1", "ramp", "more colours"}};
  for (const auto& [query, parameter, takes] : wrong) {
    const Problem found = problem(query);
    EXPECT_EQ(found.status, 400) << query;
    EXPECT_EQ(found.parameter, parameter) << query;
    EXPECT_THAT(found.takes, HasSubstr(takes)) << query;
  }
}

TEST_F(LayerStyleTest, ClassesHaveEachNumberOnceHoweverItIsWritten) {
  for (const char* query :
       {"color-by=people&classes=20:red,020:blue", "color-by=height&classes=1.5:red,15e-1:blue",
        "color-by=height&classes=0:red,-0:blue"}) {
    EXPECT_THAT(problem(query).detail, HasSubstr("more than once")) << query;
    EXPECT_EQ(problem(query).parameter, "classes") << query;
  }
  EXPECT_THAT(problem("color-by=height&classes=nan:red").detail, HasSubstr("not a number"));
  EXPECT_EQ(style("color-by=kind&classes=1:red,01:blue").classing.values.size(), 2u);
}

TEST_F(LayerStyleTest, ALayersOwnClassesExcludeBreaksForAllLayersAndTheOtherWayRound) {
  const std::string breaks = "color-by=people&breaks=10&ramp=Blues";
  const std::string classes = "color-by=people&classes=1:red";
  const std::string own_breaks = "&towns.color-by=people&towns.breaks=10&towns.ramp=Blues";
  const std::string own_classes = "&towns.color-by=people&towns.classes=1:red";
  EXPECT_EQ(style(classes + own_breaks).key(), style(breaks).key());
  EXPECT_EQ(style(breaks + own_classes).key(), style(classes).key());
  EXPECT_EQ(style("color-by=people&towns.classes=1:red").key(), style(classes).key());
}

TEST_F(LayerStyleTest, LockedParametersCannotBeSetForTheLayer) {
  served_.config.locked = {ParameterId::fill, ParameterId::filter};
  for (const char* query : {"fill=red", "towns.fill=red", "filter=people=1"}) {
    EXPECT_THAT(problem(query).detail, HasSubstr("locked")) << query;
  }
  EXPECT_EQ(style("lakes.fill=red&stroke=red").paints[0].fill, kLime);
}

TEST_F(LayerStyleTest, StylesOfTheOperatorMaySetLockedParameters) {
  served_.config.locked = {ParameterId::fill};
  const StyleBook book({{"night", testing::style_of("fill=navy")}});
  const std::vector<std::string> layers{"towns"};
  const auto complete = [&](std::vector<QueryPair> query) {
    return complete_style(*book.read(std::move(query))->style_for(layers), served_.config);
  };
  const auto night = complete({{"style", "night"}});
  ASSERT_TRUE(night);
  EXPECT_EQ(std::get<Rgba>(*night->find("towns", ParameterId::fill)), *parse_colour("navy"));
  EXPECT_FALSE(complete({{"style", "night"}, {"fill", "red"}}));
}

TEST_F(LayerStyleTest, EqualDrawingHasOneKey) {
  const std::string key = style("").key();
  EXPECT_EQ(style("fill=lime&opacity=1&stroke-linejoin=miter").key(), key);
  EXPECT_EQ(style("lakes.fill=red").key(), key);
  for (const char* query :
       {"fill=red", "fill-opacity=0.5", "opacity=0.5", "stroke=red", "pattern=dots", "ids=1",
        "highlight=1", "filter=people=1", "color-by=people&classes=1:red"}) {
    EXPECT_NE(style(query).key(), key) << query;
  }
  EXPECT_EQ(style("filter=people=1+AND+kind='x'").key(),
            style("filter=(kind='x')and 1=people").key());
  EXPECT_EQ(style("ids=3,1,2").key(), style("ids=1,2,3,3").key());
}

TEST_F(LayerStyleTest, AKeyTakesMicroseconds) {
  if (testing::kIsSanitized) GTEST_SKIP() << "sanitizers take their time";
  const auto pairs = decode_query(
                         "fill=ff8800&fill-opacity=0.5&stroke=rgb(1,2,3)&stroke-width=1.5&pattern="
                         "hatch&pattern-size=8&simplify=1&towns.small=keep&topology=fast")
                         .value();
  const std::vector<std::string> layers = {"towns"};
  constexpr int kRuns = 2000;
  std::size_t bytes = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kRuns; ++i) {
    const auto parsed = StyleQuery::parse(pairs, layers);
    bytes += parsed->canonical_text().size();
  }
  const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(bytes % kRuns, 0u);
  RecordProperty("microseconds", std::to_string(time.count() / kRuns));
  EXPECT_LT(time.count() / kRuns, 200) << "ten times what it should take, for busy machines";
}

TEST(FeatureClassCacheTest, MakesThemOnceAndStaysInItsBudget) {
  FeatureTable features({{"n", FieldType::integer}});
  for (std::int64_t i = 0; i < 1000; ++i) features.append(i, std::vector<Value>{i});
  FeatureClassCache cache(10'000);
  Classing classing;
  classing.ids = {1, 2, 3};
  EXPECT_FALSE(cache.has(1, classing));
  const auto first = cache.find(1, classing, features);
  EXPECT_TRUE(cache.has(1, classing));
  EXPECT_FALSE(cache.has(2, classing));
  EXPECT_EQ((*first)[1], 0);
  EXPECT_EQ((*first)[0], kNotDrawn);
  EXPECT_EQ(cache.find(1, classing, features), first) << "the same, not an equal one";
  EXPECT_NE(cache.find(2, classing, features), first) << "another revision of the layer";
  for (std::int64_t i = 0; i < 100; ++i) {
    classing.ids = {i};
    EXPECT_EQ((*cache.find(1, classing, features))[static_cast<std::size_t>(i)], 0);
    EXPECT_LE(cache.memory(), 10'000u);
  }
  classing.ids = {1, 2, 3};
  EXPECT_FALSE(cache.has(1, classing));
  EXPECT_NE(cache.find(1, classing, features), first) << "it had to go";
  FeatureClassCache none(10);
  EXPECT_EQ(*none.find(1, classing, features), *first);
  EXPECT_EQ(none.memory(), 0u);
}

TEST(FeatureClassCacheTest, ManyThreadsGetTheSame) {
  FeatureTable features({{"n", FieldType::integer}});
  for (std::int64_t i = 0; i < 20'000; ++i) features.append(i, std::vector<Value>{i});
  FeatureClassCache cache(1'000'000);
  Classing classing;
  classing.field = 0;
  classing.breaks = {10, 100, 1000};
  std::vector<std::shared_ptr<const FeatureClasses>> found(8);
  std::vector<std::thread> threads;
  for (auto& result : found) {
    threads.emplace_back([&] { result = cache.find(1, classing, features); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : found) EXPECT_EQ(result, found[0]);
  EXPECT_EQ((*found[0])[5], 0);
  EXPECT_EQ((*found[0])[1000], 3);
}

}  // namespace
}  // namespace trapeze
