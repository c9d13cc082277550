#include "core/layer/class_dust.h"

#include <gmock/gmock.h>

#include <map>
#include <random>

#include "core/layer/layer_builder.h"

namespace trapeze {
namespace {

/// A town of small squares with courtyards, a feature each.
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
  const Level level = nearest_level(40'000);  // all are gone
  std::vector<ClassMote> motes;
  ClassDust().gather(layer->grains(), kEverything, level, 160'000, classes, motes);
  const double of_one = 9e6 - 1e6;  // without the courtyard
  const std::map<int, double> sums = area_by_class(motes);
  ASSERT_EQ(sums.size(), 3U);
  for (const auto& [feature_class, area] : sums) EXPECT_NEAR(area, 100 * of_one, of_one);
  EXPECT_LE(motes.size(), 3U * 8 * 8);  // as many pixels as the town has, for each class
  EXPECT_TRUE(std::ranges::is_sorted(motes, {}, &ClassMote::feature_class));
}

TEST(ClassDustTest, OnlyWhatIsGoneByTheLevelAndLiesInTheBoxIsGathered) {
  const auto layer = town(3000);
  const std::vector<std::uint8_t> classes(400, 0);
  std::vector<ClassMote> motes;
  ClassDust dust;
  dust.gather(layer->grains(), kEverything, 0, 4, classes, motes);
  EXPECT_TRUE(motes.empty());
  dust.gather(layer->grains(), {0, 0, 500'000, 500'000}, kLastLevel, 1000, classes, motes);
  EXPECT_FALSE(motes.empty());
  for (const ClassMote& mote : motes) {
    EXPECT_TRUE(mote.box.intersects({-3000, -3000, 503'000, 503'000}));
  }
  const std::size_t in_the_quarter = motes.size();
  dust.gather(layer->grains(), kEverything, kLastLevel, 1000, classes, motes);
  EXPECT_LT(in_the_quarter, motes.size() / 3);
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
  std::vector<ClassMote> motes;
  ClassDust dust;
  dust.gather(layer->grains(), west, kLastLevel, pixel, classes, motes);
  const Box border{-1000, -250'000, 1000, 250'000};
  const auto from_west = within(motes, border);
  dust.gather(layer->grains(), east, kLastLevel, pixel, classes, motes);
  EXPECT_FALSE(from_west.empty());
  EXPECT_EQ(from_west, within(motes, border));
}

}  // namespace
}  // namespace trapeze
