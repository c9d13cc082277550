// Layers of polygons given by rings.
#pragma once

#include <memory>
#include <vector>

#include "core/layer/layer_builder.h"

namespace trapeze {

/// A layer with a feature of each of the polygons, in this order; nothing is known of it but its
/// number, from 1 on.
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
