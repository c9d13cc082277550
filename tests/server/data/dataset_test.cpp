#include "server/data/dataset.h"

#include <gmock/gmock.h>

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "core/layer/layer_builder.h"

namespace trapeze {
namespace {

constexpr std::int32_t kFar =
    1 << 28;  // an order of place then does not depend on the order of rows

Rings square_at(std::int32_t x) {
  Rings rings;
  rings.add(std::vector<Point>{{x, 0}, {x + 1000, 0}, {x + 1000, 1000}, {x, 1000}});
  return rings;
}

/// The revision of two named features with a square each, at these places.
std::uint64_t revision_of_squares_at(std::array<std::int32_t, 2> places) {
  FeatureTable features({{"name", FieldType::text}});
  std::vector<LayerBuilder> builders(1);
  constexpr std::array<std::string_view, 2> kNames = {"one", "other"};
  for (std::size_t i = 0; i < places.size(); ++i) {
    Rings rings = square_at(places[i]);
    const std::array<Value, 1> name = {kNames[i]};
    builders[0].add(features.append(static_cast<std::int64_t>(i), name), rings);
  }
  return revision_of(*LayerBuilder::join(builders, std::move(features)));
}

TEST(RevisionOf, IsTheSameForTheSameLayer) {
  EXPECT_EQ(revision_of_squares_at({0, kFar}), revision_of_squares_at({0, kFar}));
}

TEST(RevisionOf, ChangesWithAPlace) {
  EXPECT_NE(revision_of_squares_at({0, kFar}), revision_of_squares_at({0, kFar + 1}));
}

TEST(RevisionOf, ChangesWhenTwoFeaturesSwapTheirPolygons) {
  EXPECT_NE(revision_of_squares_at({0, kFar}), revision_of_squares_at({kFar, 0}));
}

}  // namespace
}  // namespace trapeze
