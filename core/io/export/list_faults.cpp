#include "core/io/export/list_faults.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/borders/coverage_faults.h"
#include "core/io/export/polygon_geometry.h"
#include "core/io/export/vector_file.h"
#include "core/io/load/feature_pipeline.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/source_name.h"

namespace trapeze {
namespace {

struct Found {
  std::size_t order = 0;  // of the first feature
  CoverageFault fault;
  std::vector<std::int64_t> ids;
  std::unique_ptr<OGRGeometry> geometry;
};

/// Searches for faults among features whose boxes intersect.
class FaultFinder : public FeatureWorker {
 public:
  void build_apart(const FeatureKey&, Rings&, unsigned /*threads*/) override {}

  void build_together(std::span<WaitingFeature* const> features, unsigned /*threads*/) override {
    std::vector<const Rings*> rings;
    for (const WaitingFeature* feature : features) rings.push_back(&feature->rings);
    CoverageFaults faults = find_faults(rings);
    if (!faults.failure.empty()) leave_out(features, faults.failure);
    for (CoverageFault& fault : faults.faults) take(features, std::move(fault));
  }

  std::vector<Found>& found() { return found_; }
  const std::vector<OrderedNote>& notes() const { return notes_; }
  std::size_t unsearched() const { return unsearched_; }

 private:
  void take(std::span<WaitingFeature* const> features, CoverageFault fault) {
    if (fault.polygons.empty()) return leave_out(features, fault.polygons.failure);
    Found& found = found_.emplace_back();
    found.order = features[fault.features.front()]->key.order;
    for (const std::uint32_t i : fault.features) found.ids.push_back(features[i]->key.id);
    found.geometry = geometry_of(fault.polygons, ExportCrs::degrees).geometry;
    fault.polygons = {};
    found.fault = std::move(fault);
  }

  void leave_out(std::span<WaitingFeature* const> features, const std::string& reason) {
    unsearched_ += features.size();
    const FeatureKey& first = features.front()->key;
    notes_.push_back({first.order,
                      {first.id, "it and " + std::to_string(features.size() - 1) +
                                     " features near it are not all in the list: " + reason}});
  }

  std::vector<Found> found_;
  std::vector<OrderedNote> notes_;
  std::size_t unsearched_ = 0;
};

std::string joined(const std::vector<std::int64_t>& ids) {
  std::string text;
  for (const std::int64_t id : ids) text += (text.empty() ? "" : ",") + std::to_string(id);
  return text;
}

class FaultFile {
 public:
  explicit FaultFile(const std::string& path) : file_(path) {
    file_.create_layer(ExportCrs::degrees, "fid", "geom");
    kind_ = file_.add_field("kind", {OFTString});
    area_ = file_.add_field("area", {OFTReal});
    width_ = file_.add_field("width", {OFTReal});
    features_ = file_.add_field("features", {OFTString});
  }

  void write(Found& found) {
    const OGRFeatureUniquePtr out = file_.new_feature();
    out->SetField(kind_, std::string(kFaultNames.name_of(found.fault.kind)).c_str());
    out->SetField(area_, found.fault.area);
    out->SetField(width_, found.fault.width);
    out->SetField(features_, joined(found.ids).c_str());
    file_.write(*out, std::move(found.geometry));
  }

  void finish() { file_.finish(); }

 private:
  VectorFile file_;
  int kind_ = 0;
  int area_ = 0;
  int width_ = 0;
  int features_ = 0;
};

FaultReport list(FeatureSource& source, FaultFile& file, const FaultOptions& options) {
  std::deque<FaultFinder> finders(thread_count(options.threads));
  std::vector<FeatureWorker*> workers;
  workers.reserve(finders.size());
  for (FaultFinder& finder : finders) workers.push_back(&finder);
  LayerOptions together;
  together.coverage = CoverageMode::on;
  FeaturePipeline pipeline(source, together, workers, options.progress);
  std::uint32_t rows = 0;
  pipeline.run([&rows](SourceFeature&) { return rows++; }, {});

  FaultReport report;
  std::vector<Found> faults;
  std::vector<OrderedNote> notes;
  for (FaultFinder& finder : finders) {
    report.unsearched += finder.unsearched();
    for (Found& found : finder.found()) faults.push_back(std::move(found));
    notes.insert(notes.end(), finder.notes().begin(), finder.notes().end());
  }
  for (const FeatureTally* tally : pipeline.tallies()) {
    notes.insert(notes.end(), tally->skips.begin(), tally->skips.end());
  }
  // Faults with the same first feature come from one group, in its order.
  std::ranges::stable_sort(faults, {}, &Found::order);
  sort_by_order(notes);
  for (Found& found : faults) {
    ++(found.fault.kind == FaultKind::gap ? report.gaps : report.overlaps);
    file.write(found);
  }
  for (OrderedNote& note : notes) report.notes.push_back(std::move(note.note));
  return report;
}

}  // namespace

FaultReport list_faults(const std::string& source, const std::string& output,
                        const FaultOptions& options) {
  VectorFile::check_path(output, source, options.overwrite);
  FeatureSource features(source);
  FaultFile file(output);
  try {
    FaultReport report = list(features, file, options);
    file.finish();
    if (options.progress) options.progress(1);
    return report;
  } catch (const SourceError& error) {
    throw std::runtime_error(name_of_source(source) + ": " + error.what());
  }
}

}  // namespace trapeze
