// Layers of polygons given as rings.
#pragma once

#include <memory>
#include <vector>

#include "core/grid/grid.h"
#include "core/layer/layer_builder.h"

namespace trapeze {

/// All of the grid.
inline constexpr Box kEverywhere{kGridMin, kGridMin, kGridMax, kGridMax};

/// A square from its corner with the least coordinates.
inline Rings square(std::int32_t x, std::int32_t y, std::int32_t side) {
  Rings rings;
  rings.add(std::vector<Point>{{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}});
  return rings;
}

/// A layer with one feature for each polygon, in this order. The features have no attributes; their
/// ids count from 1.
inline std::unique_ptr<Layer> layer_of(std::vector<Rings> polygons,
                                       const LayerOptions& options = {}) {
  FeatureTable features((std::vector<Field>()));
  std::vector<LayerBuilder> builders;
  builders.emplace_back(options);
  for (Rings& rings : polygons) {
    const std::uint32_t row = features.append(static_cast<std::int64_t>(features.size()) + 1, {});
    builders.front().add(row, rings);
  }
  return LayerBuilder::join(builders, std::move(features));
}

}  // namespace trapeze
