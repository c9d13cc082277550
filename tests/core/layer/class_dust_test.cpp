#include "core/layer/class_dust.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "core/layer/layer_builder.h"

namespace trapeze {
namespace {

/// A town of small square buildings with courtyards, one feature each.
std::unique_ptr<Layer> town(std::int32_t side) {
  FeatureTable features((std::vector<Field>()));
  std::vector<LayerBuilder> builders(1);
  std::mt19937 random(7);
  const auto place = [&random] {
    return std::uniform_int_distribution<std::int32_t>(-500'000, 500'000)(random);
  };
  for (int i = 0; i < 400; ++i) {
    Rings rings;
    const std::int32_t x = place();
    const std::int32_t y = place();
    for (const std::int32_t inset : {0, side / 3}) {
      const std::int32_t far = side - inset;
      rings.add(std::vector<Point>{
          {x + inset, y + inset}, {x + far, y + inset}, {x + far, y + far}, {x + inset, y + far}});
    }
    builders.front().add(features.append(i, {}), rings);
  }
  return LayerBuilder::join(builders, std::move(features));
}

double area_of(const Box& box) {
  return (static_cast<double>(box.max_x) - box.min_x) *
         (static_cast<double>(box.max_y) - box.min_y);
}

std::map<int, double> area_by_class(const std::vector<ClassMote>& motes) {
  std::map<int, double> sums;
  for (const ClassMote& mote : motes) {
    sums[mote.feature_class] += mote.is_hole ? -area_of(mote.box) : area_of(mote.box);
  }
  return sums;
}

constexpr Box kEverything{kGridMin, kGridMin, kGridMax, kGridMax};

TEST(ClassDustTest, EveryClassKeepsTheAreaOfItsFeatures) {
  const std::int32_t side = 3000;
  const auto layer = town(side);
  std::vector<std::uint8_t> classes(400);
  for (std::size_t row = 0; row < classes.size(); ++row) {
    classes[row] = row % 4 == 3 ? kNotDrawn : static_cast<std::uint8_t>(row % 4);
  }
  const Level level = nearest_level(40'000);  // all are below it
  ClassShapes shapes;
  ClassDust().gather(layer->grains(), {kEverything, {0, level}, 160'000}, classes, shapes);
  const double of_one = 9e6 - 1e6;  // without the courtyard
  const std::map<int, double> sums = area_by_class(shapes.motes);
  ASSERT_EQ(sums.size(), 3U);
  for (const auto& [feature_class, area] : sums) EXPECT_NEAR(area, 100 * of_one, of_one);
  EXPECT_LE(shapes.motes.size(), 3U * 8 * 8);  // at most the pixels of the town per class
  EXPECT_TRUE(std::ranges::is_sorted(shapes.motes, {}, &ClassMote::feature_class));
}

TEST(ClassDustTest, OnlyWhatIsGoneByTheLevelAndLiesInTheBoxIsGathered) {
  const auto layer = town(3000);
  const std::vector<std::uint8_t> classes(400, 0);
  ClassShapes shapes;
  ClassDust dust;
  dust.gather(layer->grains(), {kEverything, {0, 0}, 4}, classes, shapes);
  EXPECT_TRUE(shapes.motes.empty());
  // Buildings are 3000 cells wide and reach at most this far beyond the box.
  const Box near{-6010, -6010, 506'010, 506'010};
  dust.gather(layer->grains(), {{0, 0, 500'000, 500'000}, {0, kLastLevel}, 4000}, classes, shapes);
  EXPECT_FALSE(shapes.motes.empty());
  for (const ClassMote& mote : shapes.motes) EXPECT_TRUE(mote.box.intersects(near));
  const std::size_t in_the_quarter = shapes.motes.size();
  dust.gather(layer->grains(), {kEverything, {0, kLastLevel}, 4000}, classes, shapes);
  EXPECT_LT(in_the_quarter, shapes.motes.size() / 3);
}

TEST(ClassDustTest, WhatIsLargerThanAPixelIsAPatchWhereItWas) {
  const auto layer = town(3000);
  const std::vector<std::uint8_t> classes(400, 0);
  ClassShapes shapes;
  ClassDust().gather(layer->grains(), {kEverything, {0, kLastLevel}, 900}, classes, shapes);
  // 400 buildings, and 400 courtyards that are subtracted from them.
  EXPECT_TRUE(shapes.motes.empty());
  EXPECT_EQ(shapes.patches.size(), 800U);
  EXPECT_EQ(std::ranges::count_if(shapes.patches, &ClassPatch::is_hole), 400);
  for (const ClassPatch& patch : shapes.patches) {
    const double dx = static_cast<double>(patch.corners[1].x) - patch.corners[0].x;
    const double dy = static_cast<double>(patch.corners[1].y) - patch.corners[0].y;
    EXPECT_NEAR(std::hypot(dx, dy), patch.is_hole ? 1000 : 3000, 3);
  }
}

TEST(ClassDustTest, TilesAgreeOnThePixelsAlongTheirBorder) {
  const auto layer = town(3000);
  const std::vector<std::uint8_t> classes(400, 0);
  const auto within = [](const std::vector<ClassMote>& motes, const Box& box) {
    std::vector<std::array<std::int32_t, 4>> boxes;
    for (const ClassMote& m : motes) {
      if (!m.box.intersects(box)) continue;
      boxes.push_back({m.box.min_x, m.box.min_y, m.box.max_x, m.box.max_y});
    }
    return boxes;
  };
  const double pixel = 8192;
  const Box west{-300'000, -300'000, 2 * 8192, 300'000};
  const Box east{-2 * 8192, -300'000, 300'000, 300'000};
  ClassShapes shapes;
  ClassDust dust;
  dust.gather(layer->grains(), {west, {0, kLastLevel}, pixel}, classes, shapes);
  const Box border{-1000, -250'000, 1000, 250'000};
  const auto from_west = within(shapes.motes, border);
  dust.gather(layer->grains(), {east, {0, kLastLevel}, pixel}, classes, shapes);
  EXPECT_FALSE(from_west.empty());
  EXPECT_EQ(from_west, within(shapes.motes, border));
}

}  // namespace
}  // namespace trapeze
