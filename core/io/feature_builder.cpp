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

FeatureBuilder::FeatureBuilder(const std::vector<SourceLayer>& layers, RingReader::Options options,
                               const GeneralizationOptions& generalization)
    : layers_(layers), options_(options), readers_(layers.size()), builder_(generalization) {}

void FeatureBuilder::build(const FeatureJob& job) {
  reader_of(job.layer_index).read(*job.geometry, feature_);
  tally_.polygons += feature_.polygons;
  tally_.rings += feature_.source_rings;
  tally_.source_vertices += feature_.vertices;
  if (feature_.has_wrong_units) {
    throw SourceError("names no coordinate reference system, and its coordinates are not degrees");
  }
  if (!feature_.failure.empty()) {
    tally_.skip(job.order, job.id, feature_.failure);
  } else if (feature_.rings.empty()) {
    ++tally_.empty;
  } else {
    count(job, builder_.add(job.row, feature_.rings));
  }
}

RingReader& FeatureBuilder::reader_of(std::size_t layer_index) {
  std::unique_ptr<RingReader>& reader = readers_[layer_index];
  if (reader == nullptr) {
    reader = std::make_unique<RingReader>(layers_[layer_index].crs, options_);
  }
  return *reader;
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
