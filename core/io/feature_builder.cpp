#include "core/io/feature_builder.h"

#include <utility>

namespace trapeze {

void BuildTally::skip(std::size_t order, std::int64_t id, std::string reason) {
  ++skipped;
  skips.push_back({order, {id, std::move(reason)}});
}

void BuildTally::remark(std::size_t order, std::int64_t id, std::string words) {
  if (remarks.size() < kMaxRemarks) remarks.push_back({order, {id, std::move(words)}});
}

void FeatureBuilder::build(const FeatureJob& job) {
  FeatureRings& feature = reader_.read(*job.geometry, job.layer_index);
  tally_.polygons += feature.polygons;
  tally_.rings += feature.source_rings;
  tally_.source_vertices += feature.vertices;
  if (!feature.failure.empty()) {
    tally_.skip(job.order, job.id, feature.failure);
  } else if (feature.rings.empty()) {
    ++tally_.empty;
  } else {
    count(job, builder_.add(job.row, feature.rings));
  }
}

void FeatureBuilder::count(const FeatureJob& job, const BuildOutcome& outcome) {
  tally_.collapsed_rings += outcome.collapsed_rings;
  if (!outcome.failure.empty()) {
    tally_.skip(job.order, job.id, outcome.failure);
    return;
  }
  if (!outcome.built) {
    ++tally_.empty;
    return;
  }
  ++tally_.loaded;
  tally_.vertices += outcome.vertices;
  if (!outcome.noded) return;
  ++tally_.repaired;
  tally_.remark(job.order, job.id, "repaired: its rings cross or touch");
}

}  // namespace trapeze
