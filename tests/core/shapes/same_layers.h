// Whether two layers are the same, array by array and byte by byte.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "core/layer/layer_arrays.h"

namespace trapeze {

inline void expect_same_layers(const Layer& one, const Layer& other) {
  const LayerArrays a = arrays_of(one);
  const LayerArrays b = arrays_of(other);
  const auto are_same = [](const auto& x, const auto& y) {
    return std::ranges::equal(std::as_bytes(std::span(x)), std::as_bytes(std::span(y)));
  };
  EXPECT_TRUE(are_same(a.vertices, b.vertices));
  EXPECT_TRUE(are_same(a.edges, b.edges));
  EXPECT_TRUE(are_same(a.trapezoids, b.trapezoids));
  EXPECT_TRUE(are_same(a.lifespans, b.lifespans));
  EXPECT_TRUE(are_same(a.feature_of, b.feature_of));
  EXPECT_TRUE(are_same(a.outline.loop_sizes, b.outline.loop_sizes));
  EXPECT_TRUE(are_same(a.outline.milestone_ends, b.outline.milestone_ends));
  EXPECT_TRUE(are_same(a.outline.milestones, b.outline.milestones));
  EXPECT_TRUE(are_same(a.outline.milestone_levels, b.outline.milestone_levels));
  EXPECT_TRUE(are_same(a.polygon_index, b.polygon_index));
  EXPECT_TRUE(are_same(a.horizontal_edge_index, b.horizontal_edge_index));
  EXPECT_TRUE(are_same(a.mote_index, b.mote_index));
  EXPECT_TRUE(are_same(a.merged_mote_index, b.merged_mote_index));
  EXPECT_TRUE(are_same(a.grains, b.grains));
  EXPECT_TRUE(are_same(a.overlaps, b.overlaps));
  EXPECT_TRUE(are_same(a.outline_points, b.outline_points));
  EXPECT_TRUE(are_same(a.ring_ends, b.ring_ends));
  EXPECT_TRUE(are_same(a.outline_ends, b.outline_ends));
  EXPECT_TRUE(are_same(a.units.features, b.units.features));
  EXPECT_TRUE(are_same(a.units.groups, b.units.groups));
  EXPECT_TRUE(are_same(a.units.members, b.units.members));
  EXPECT_TRUE(are_same(a.units.overlaps, b.units.overlaps));
}

}  // namespace trapeze
