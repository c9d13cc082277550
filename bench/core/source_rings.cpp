#include "bench/core/source_rings.h"

#include <memory>

#include "core/io/source/feature_source.h"
#include "core/io/source/open_source.h"
#include "core/io/source/ring_reader.h"

namespace trapeze {

std::vector<Rings> read_source_rings(const std::string& path) {
  FeatureSource source(path);
  const RingReader::Options options{has_clockwise_shells(source.driver())};
  std::vector<std::unique_ptr<RingReader>> readers;
  for (const SourceLayer& layer : source.layers()) {
    readers.push_back(std::make_unique<RingReader>(layer.crs, options));
  }
  std::vector<Rings> all;
  FeatureRings feature;
  for (SourceFeature next; source.next(next);) {
    if (next.layer == nullptr) continue;
    const OGRGeometry* geometry = next.feature->GetGeomFieldRef(next.layer->geometry_field);
    if (geometry == nullptr || !has_polygons(*geometry)) continue;
    readers[next.layer_index]->read(*geometry, feature);
    if (feature.failure.empty() && !feature.rings.empty()) all.push_back(feature.rings);
  }
  return all;
}

}  // namespace trapeze
