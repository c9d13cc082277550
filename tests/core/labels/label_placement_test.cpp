#include "core/labels/label_placement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/grid/grid.h"

namespace trapeze {
namespace {

constexpr auto kWorld = static_cast<double>(kGridSize);

std::vector<LabelCandidate> random_candidates(std::mt19937& random, int count, double reach) {
  std::vector<LabelCandidate> made;
  std::uniform_real_distribution<double> place(-reach, reach);
  std::uniform_real_distribution<float> size(3, 60);
  std::uniform_real_distribution<double> zoom(-5, 12);
  for (int i = 0; i < count; ++i) {
    made.push_back({std::round(place(random)), std::round(place(random)), size(random),
                    size(random) / 4, std::exp2(zoom(random)) * 256 / kWorld});
  }
  return made;
}

double across(double a, double b, double world) {
  const double apart = std::abs(a - b);
  return world > 0 ? std::min(apart, world - apart) : apart;
}

bool overlap(const LabelCandidate& a, const LabelCandidate& b, double scale, double world) {
  constexpr double kRounding = 1e-3;
  return across(a.x, b.x, world) * scale < a.half_width + b.half_width - kRounding &&
         std::abs(a.y - b.y) * scale < a.half_height + b.half_height - kRounding;
}

/// At every step no two labels overlap. A label that is not shown is too small there or overlaps
/// one that is shown.
void expect_well_placed(const LabelPlacement& placement, double world) {
  const auto all = placement.candidates();
  for (int step = 0; step < LabelPlacement::kSteps; ++step) {
    const double scale = LabelPlacement::pixels_per_cell_of(step);
    std::vector<std::uint32_t> shown;
    for (std::uint32_t i = 0; i < all.size(); ++i) {
      if (placement.first_step_of(i) <= step) shown.push_back(i);
    }
    for (std::size_t i = 0; i < shown.size(); ++i) {
      ASSERT_LE(all[shown[i]].least_scale, scale * (1 + 1e-9));
      for (std::size_t k = 0; k < i; ++k) {
        ASSERT_FALSE(overlap(all[shown[i]], all[shown[k]], scale, world))
            << shown[i] << " and " << shown[k] << " at step " << step;
      }
    }
    for (std::uint32_t i = 0; i < all.size(); ++i) {
      const bool may_be_shown =
          all[i].least_scale <= scale && (world == 0 || 2 * all[i].half_width / world <= scale);
      if (placement.first_step_of(i) <= step || !may_be_shown) continue;
      ASSERT_TRUE(std::ranges::any_of(shown,
                                      [&](std::uint32_t k) {
                                        LabelCandidate larger = all[k];
                                        larger.half_width += 0.01F;
                                        larger.half_height += 0.01F;
                                        return overlap(all[i], larger, scale, world);
                                      }))
          << i << " has room at step " << step;
    }
  }
}

TEST(LabelPlacementTest, RoundedPixelsAtHalfZoomsHaveOneStep) {
  for (int step = 1; step < 36; ++step) {
    const double scale = LabelPlacement::pixels_per_cell_of(step);
    EXPECT_EQ(LabelPlacement::step_of(scale * (1 - 2e-4)), step);
    EXPECT_EQ(LabelPlacement::step_of(scale * (1 + 2e-4)), step);
  }
}

TEST(LabelPlacementTest, NoneOverlapAndNoneIsMissingAtAnyScale) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const double world : {0.0, kWorld}) {
    for (const double reach : {kWorld / 2, 1e6, 2e4}) {
      expect_well_placed(LabelPlacement(random_candidates(random, 150, reach), world), world);
    }
  }
}

TEST(LabelPlacementTest, ThePriorityDecides) {
  const double scale = LabelPlacement::pixels_per_cell_of(20);
  const double apart = 30 / scale;  // pixels
  const std::vector<LabelCandidate> three = {
      {apart, 0, 20, 5, scale}, {0, 0, 20, 5, scale}, {2 * apart, 0, 20, 5, scale}};
  const LabelPlacement placement(three, 0);
  EXPECT_EQ(placement.first_step_of(0), 20);
  // It takes 40 pixels; half a zoom gives 42.
  EXPECT_EQ(placement.first_step_of(1), 21);
  EXPECT_EQ(placement.first_step_of(2), 21);
}

TEST(LabelPlacementTest, WhatIsInOnePlaceIsNeverShownTogether) {
  const LabelPlacement placement({{5, 5, 9, 9, 0}, {5, 5, 9, 9, 0}}, 0);
  EXPECT_EQ(placement.first_step_of(0), 0);
  EXPECT_EQ(placement.first_step_of(1), LabelPlacement::kSteps);
  EXPECT_EQ(placement.size(), 1u);
}

TEST(LabelPlacementTest, TheWorldRepeats) {
  const double scale = LabelPlacement::pixels_per_cell_of(12);
  const double near_edge = kWorld / 2 - 5 / scale;
  const std::vector<LabelCandidate> two = {{near_edge, 0, 20, 5, scale},
                                           {-near_edge, 0, 20, 5, scale}};
  EXPECT_EQ(LabelPlacement(two, 0).first_step_of(1), 12);
  EXPECT_GT(LabelPlacement(two, kWorld).first_step_of(1), 12) << "they lie side by side";
}

TEST(LabelPlacementTest, StepsAreHalfZooms) {
  const double zoom0 = 256 / kWorld;
  EXPECT_EQ(LabelPlacement::step_of(zoom0), -2 * LabelPlacement::kFirstZoom);
  EXPECT_EQ(LabelPlacement::step_of(zoom0 * 1.4), -2 * LabelPlacement::kFirstZoom);
  EXPECT_EQ(LabelPlacement::step_of(zoom0 * 1.5), -2 * LabelPlacement::kFirstZoom + 1);
  EXPECT_EQ(LabelPlacement::step_of(zoom0 / 1024), std::nullopt);
  EXPECT_EQ(LabelPlacement::step_of(1e9), LabelPlacement::kSteps - 1);
}

TEST(LabelPlacementTest, WhatIsFoundIsWhatMeetsTheBox) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const double reach = 3e6;
  const LabelPlacement placement(random_candidates(random, 2'000, reach), kWorld);
  std::uniform_real_distribution<double> place(-reach, reach);
  std::uniform_real_distribution<double> zoom(2, 14);
  std::size_t count = 0;
  for (int i = 0; i < 400; ++i) {
    const double scale = std::exp2(zoom(random)) * 256 / kWorld;
    const double x = place(random);
    const double y = place(random);
    const PlaneBox box{x, y, x + 256 / scale, y + 256 / scale};
    const double slack = 4;
    std::vector<std::uint32_t> found;
    placement.find(box, scale, slack, found);
    std::ranges::sort(found);
    std::vector<std::uint32_t> expected;
    bool is_any_later = false;
    for (std::uint32_t k = 0; k < placement.candidates().size(); ++k) {
      const LabelCandidate& c = placement.candidates()[k];
      if (placement.first_step_of(k) == LabelPlacement::kSteps) continue;
      const double half_x = (c.half_width + slack) / scale;
      const double half_y = (c.half_height + slack) / scale;
      if (c.x + half_x < box.min_x || c.x - half_x > box.max_x || c.y + half_y < box.min_y ||
          c.y - half_y > box.max_y) {
        continue;
      }
      if (placement.first_step_of(k) <= LabelPlacement::step_of(scale)) expected.push_back(k);
      is_any_later = true;
    }
    EXPECT_EQ(found, expected);
    if (is_any_later) {
      EXPECT_TRUE(placement.is_any_from(box, scale, slack));
    }
    count += found.size();
  }
  EXPECT_GT(count, 100u);
  EXPECT_FALSE(placement.is_any_from({1e9, 1e9, 1.001e9, 1.001e9}, 1e-3, 4));
}

}  // namespace
}  // namespace trapeze
