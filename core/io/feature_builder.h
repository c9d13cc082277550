// The part of loading that runs on every core: from geometries to graphs, and what became of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <ogr_geometry.h>

#include "core/io/feature_source.h"
#include "core/io/load_layer.h"
#include "core/io/source_ring_reader.h"
#include "core/layer_builder.h"

namespace trapeze {

/// A polygon feature on its way from the reading thread to a builder.
struct FeatureJob {
  std::size_t order = 0;  // counts the features of the source
  std::uint32_t row = 0;
  std::int64_t id = 0;
  std::size_t layer_index = 0;
  std::unique_ptr<OGRGeometry> geometry;
};

/// A note and the feature it is about, to be brought into the order of the source.
struct OrderedNote {
  std::size_t order = 0;
  FeatureNote note;
};

/// What became of the features: sums, which do not depend on who built what.
struct BuildTally {
  std::size_t loaded = 0;
  std::size_t empty = 0;
  std::size_t skipped = 0;
  std::size_t polygons = 0;
  std::size_t rings = 0;
  std::size_t source_vertices = 0;
  std::size_t vertices = 0;
  std::size_t collapsed_rings = 0;
  std::size_t repaired = 0;
  std::vector<OrderedNote> skips;
  std::vector<OrderedNote> remarks;  // the first kMaxRemarks, on features that were not skipped

  static constexpr std::size_t kMaxRemarks = 100;

  void skip(std::size_t order, std::int64_t id, std::string reason);
  void remark(std::size_t order, std::int64_t id, std::string words);
};

/// Belongs to one thread. Gets its jobs in ascending order.
class FeatureBuilder {
 public:
  /// `source` must outlive the builder.
  FeatureBuilder(const FeatureSource& source, const GeneralizationOptions& generalization)
      : reader_(source), builder_(generalization) {}

  /// Builds the graph of one feature. Throws SourceError if the whole source cannot be
  /// understood: it names no CRS and is not in degrees, or there is no way from its CRS.
  void build(const FeatureJob& job);

  const BuildTally& tally() const { return tally_; }
  LayerBuilder take_builder() { return std::move(builder_); }

 private:
  void count(const FeatureJob& job, const BuildOutcome& outcome);

  SourceRingReader reader_;
  LayerBuilder builder_;
  BuildTally tally_;
};

}  // namespace trapeze
