#include "core/io/load/huge_pages.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/layer/layer_arrays.h"
#include "core/layer/layer_builder.h"

namespace trapeze {
namespace {

/// `count` squares in rows of a thousand.
std::unique_ptr<Layer> squares(int count) {
  std::vector<LayerBuilder> builders(1);
  FeatureTable features;
  for (int i = 0; i < count; ++i) {
    const int x = i % 1000 * 20;
    const int y = i / 1000 * 20;
    Rings rings;
    rings.add(std::vector<Point>{{x, y}, {x + 10, y}, {x + 10, y + 10}, {x, y + 10}});
    builders[0].add(features.append(i, {}), rings);
  }
  return LayerBuilder::join(builders, std::move(features));
}

template <typename T>
std::vector<T> copy(std::span<const T> items) {
  return {items.begin(), items.end()};
}

TEST(HugePages, ALayerIsTheSameInThem) {
  const auto layer = squares(200'000);
  const LayerArrays before = arrays_of(*layer);
  const auto vertices = copy(before.vertices);
  const auto edges = copy(before.edges);
  const auto trapezoids = copy(before.trapezoids);
  ASSERT_GT(before.vertices.size_bytes(), std::size_t{4} << 20);
  const std::size_t pages = move_to_huge_pages(*layer);
  EXPECT_LE(pages << 21, layer->memory()) << "none takes more memory than there was";
  const LayerArrays after = arrays_of(*layer);
  EXPECT_EQ(after.vertices.data(), before.vertices.data());
  EXPECT_EQ(copy(after.vertices), vertices);
  EXPECT_EQ(copy(after.edges), edges);
  EXPECT_EQ(copy(after.trapezoids), trapezoids);
}

TEST(HugePages, WhatFillsNoneStaysWhereItIs) {
  EXPECT_EQ(move_to_huge_pages(*squares(10)), 0u);
}

}  // namespace
}  // namespace trapeze
