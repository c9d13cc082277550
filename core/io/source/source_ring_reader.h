// Reads the geometries of all layers of a source as rings on the grid.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <ogr_geometry.h>

#include "core/io/source/feature_source.h"
#include "core/io/source/ring_reader.h"

namespace trapeze {

/// Use only on the thread that created it; several readers may read geometries of one source at the
/// same time.
class SourceRingReader {
 public:
  /// For that grid, null being Web Mercator. `source` must outlive the reader.
  explicit SourceRingReader(const FeatureSource& source,
                            std::shared_ptr<const TargetGrid> grid = {});

  /// The rings of a geometry of that layer. They are overwritten by the next call, and the caller
  /// may change them. Throws SourceError if the source as a whole cannot be interpreted: it has no
  /// CRS and is not in degrees, or its CRS cannot be transformed.
  FeatureRings& read(const OGRGeometry& geometry, std::size_t layer_index);

 private:
  const std::vector<SourceLayer>& layers_;
  const std::string driver_;
  RingReader::Options options_;
  bool stores_rings_alone_;                           // without specifying which of them belong
                                                      // together
  std::vector<std::unique_ptr<RingReader>> readers_;  // by layer, created when first needed
  FeatureRings feature_;                              // memory kept between calls
};

}  // namespace trapeze
