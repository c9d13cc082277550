#include "tests/core/io/data/source_rings.h"

#include <gtest/gtest.h>

#include "core/grid/tolerance.h"
#include "core/grid/web_mercator.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/source_ring_reader.h"

namespace trapeze::testing {

std::vector<Rings> rings_of_source(const std::string& path) {
  FeatureSource source(path);
  SourceRingReader reader(source);
  std::vector<Rings> features;
  for (SourceFeature next; source.next(next);) {
    const OGRGeometry* geometry = next.feature->GetGeomFieldRef(next.layer->geometry_field);
    if (geometry == nullptr || !has_polygons(*geometry)) continue;
    const FeatureRings& feature = reader.read(*geometry, next.layer_index);
    EXPECT_EQ(feature.failure, "") << "feature " << next.feature->GetFID();
    features.push_back(feature.rings);
  }
  return features;
}

double epsilon_of_zoom(int zoom) {
  constexpr double kTolerancePixels = 0.25;
  constexpr double kPixelsPerTile = 256;
  const double cells_per_pixel = static_cast<double>(TileId{zoom, 0, 0}.side()) / kPixelsPerTile;
  return epsilon_of_level(nearest_level(kTolerancePixels * cells_per_pixel));
}

}  // namespace trapeze::testing
