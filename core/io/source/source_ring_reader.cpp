#include "core/io/source/source_ring_reader.h"

#include <utility>

#include "core/io/source/open_source.h"

namespace trapeze {

SourceRingReader::SourceRingReader(const FeatureSource& source,
                                   std::shared_ptr<const TargetGrid> grid)
    : layers_(source.layers()),
      driver_(source.driver()),
      options_{.shells_are_clockwise = has_clockwise_shells(source.driver()),
               .grid = std::move(grid)},
      stores_rings_alone_(source.driver() == "OSM"),
      readers_(source.layers().size()) {}

FeatureRings& SourceRingReader::read(const OGRGeometry& geometry, std::size_t layer_index) {
  std::unique_ptr<RingReader>& reader = readers_[layer_index];
  if (reader == nullptr) reader = std::make_unique<RingReader>(layers_[layer_index].crs, options_);
  reader->read(geometry, feature_);
  if (stores_rings_alone_) feature_.part_ends.clear();
  if (feature_.has_wrong_units) {
    throw SourceError(no_degrees_words(driver_));
  }
  return feature_;
}

}  // namespace trapeze
