// The part of loading that runs on every core: from geometries to graphs, and what became of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <ogr_geometry.h>

#include "core/io/load/load_report.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/source_ring_reader.h"
#include "core/layer/layer_builder.h"

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
  CoverageCounts coverage;
  std::vector<OrderedNote> skips;
  std::vector<OrderedNote> remarks;  // the first kMaxRemarks, on features that were not skipped

  static constexpr std::size_t kMaxRemarks = 100;

  void skip(std::size_t order, std::int64_t id, std::string reason);
  void remark(std::size_t order, std::int64_t id, std::string words);
};

/// A feature that waits for the others, with which it may share borders.
struct WaitingFeature {
  std::size_t order = 0;
  std::uint32_t row = 0;
  std::int64_t id = 0;
  Rings rings;  // clean, not empty
};

/// Belongs to one thread. Gets its jobs in ascending order.
class FeatureBuilder {
 public:
  /// `source` must outlive the builder.
  FeatureBuilder(const FeatureSource& source, const LayerOptions& generalization)
      : reader_(source), generalization_(generalization), builder_(generalization) {}

  /// Builds the graph of one feature; if coverages are wanted, reads its rings only, and lets it
  /// wait. Throws SourceError if the whole source cannot be understood: it names no CRS and is not
  /// in degrees, or there is no way from its CRS.
  void build(const FeatureJob& job);

  std::vector<WaitingFeature> take_waiting() { return std::exchange(waiting_, {}); }
  /// Builds the graph of a feature that waited. Its rings are used up.
  void build_apart(WaitingFeature& feature);
  /// Builds one graph of several, in ascending order of rows, but for those that have to be built
  /// apart (see assemble()). Their rings are used up.
  void build_together(std::span<WaitingFeature* const> features);

  /// Brings the borders of features together that waited; their rings are still those of each.
  void close_gaps(std::span<WaitingFeature> features);

  const BuildTally& tally() const { return tally_; }
  LayerBuilder take_builder() { return std::move(builder_); }

 private:
  struct Subject {
    std::size_t order;
    std::int64_t id;
  };
  void wait(const FeatureJob& job, Rings& rings);
  void count(const Subject& subject, const BuildOutcome& outcome);
  void count(std::span<WaitingFeature* const> features, const Assembly& assembly);

  SourceRingReader reader_;
  LayerOptions generalization_;
  LayerBuilder builder_;
  std::vector<WaitingFeature> waiting_;
  BuildTally tally_;
};

/// Builds all features that wait in the builders, with those with which they share borders, on a
/// thread for each builder. What comes of it does not depend on their number.
void build_waiting(std::vector<FeatureBuilder>& builders, const LayerOptions& options);

}  // namespace trapeze
