#include "core/io/load/load_layer.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <optional>
#include <utility>

#include "core/io/load/feature_builder.h"
#include "core/io/load/feature_pipeline.h"
#include "core/io/load/huge_pages.h"
#include "core/io/load/source_division.h"
#include "core/io/source/attribute_reader.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/source_name.h"
#include "core/io/source/target_grid.h"
#include "core/layer/earlier_layer.h"
#include "core/layer/layer_arrays.h"

namespace trapeze {
namespace {

// Fraction of the time; the rest is for joining what the threads have built.
constexpr double kPipelineShare = 0.78;

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

/// The table of a layer, filled while features arrive.
class TableReader {
 public:
  TableReader(const FeatureSource& source, const SourceSelection& selection)
      : attributes_(selection.attributes) {
    for (const SourceLayer& layer : source.layers()) {
      attributes_.add_layer(*layer.layer->GetLayerDefn());
    }
    table_ = FeatureTable(attributes_.fields());
  }

  std::uint32_t append(SourceFeature& next) {
    return table_.append(next.feature->GetFID(), attributes_.read(*next.feature, next.layer_index));
  }
  FeatureTable take_table() { return std::move(table_); }

 private:
  AttributeReader attributes_;
  FeatureTable table_;
};

void add_sums(const FeatureTally& tally, LoadReport& report) {
  report.loaded += tally.loaded;
  report.other_geometry += tally.other_geometry;
  report.empty += tally.empty;
  report.skipped += tally.skipped;
  report.polygons += tally.polygons;
  report.rings += tally.rings;
  report.source_vertices += tally.source_vertices;
  report.vertices += tally.vertices;
  report.collapsed_rings += tally.collapsed_rings;
  report.repaired += tally.repaired;
  for (const auto count : kCoverageCounts) report.coverage.*count += tally.coverage.*count;
}

// Every tally kept its first remarks, so the first ones overall are among them.
std::vector<FeatureNote> join_notes(const std::vector<const FeatureTally*>& tallies) {
  std::vector<OrderedNote> remarks;
  std::vector<OrderedNote> notes;
  for (const FeatureTally* tally : tallies) {
    remarks.insert(remarks.end(), tally->remarks.begin(), tally->remarks.end());
    notes.insert(notes.end(), tally->skips.begin(), tally->skips.end());
  }
  sort_by_order(remarks);
  remarks.resize(std::min(remarks.size(), FeatureTally::kMaxRemarks));
  notes.insert(notes.end(), remarks.begin(), remarks.end());
  sort_by_order(notes);
  std::vector<FeatureNote> result;
  result.reserve(notes.size());
  for (OrderedNote& note : notes) result.push_back(std::move(note.note));
  return result;
}

void fill_report(const FeaturePipeline& pipeline, const std::deque<FeatureBuilder>& builders,
                 const FeatureSource& source, bool is_first_part, LoadReport& report) {
  report.driver = source.driver();
  report.warnings = source.warnings();
  const std::size_t passed_over = is_first_part ? source.passed_over() : 0;
  report.features = pipeline.features() + passed_over;
  report.other_geometry = passed_over;
  std::vector<const FeatureTally*> tallies = pipeline.tallies();
  for (const FeatureBuilder& builder : builders) {
    tallies.push_back(&builder.tally());
    report.taken_over += builder.taken_over();
  }
  for (const FeatureTally* tally : tallies) add_sums(*tally, report);
  report.notes = join_notes(tallies);
}

void warn_of_unknown_overlaps(const Layer& layer, LoadReport& report) {
  if (layer.has_all_overlaps()) return;
  report.warnings.push_back("so many features overlap that not all pairs are known (" +
                            std::to_string(layer.overlaps().pairs().size() / 2) +
                            " are): where others overlap, their colours mix");
}

std::unique_ptr<Layer> join_layer(std::deque<FeatureBuilder>& builders, FeatureTable table,
                                  const std::function<void(double)>& progress, unsigned threads) {
  std::vector<LayerBuilder> parts;
  parts.reserve(builders.size());
  for (FeatureBuilder& builder : builders) parts.push_back(builder.take_builder());
  std::unique_ptr<Layer> layer = LayerBuilder::join(parts, std::move(table), progress, threads);
  move_to_huge_pages(*layer);
  return layer;
}

bool can_take_over(const LoadOptions& options) {
  return options.earlier != nullptr &&
         arrays_of(*options.earlier).options == options.generalization;
}

/// Throws SourceError if the features differ from those that were divided.
void keep_part(FeatureSource& source, const LoadOptions& options) {
  const auto is_wanted = [division = options.division, part = options.part](std::size_t order) {
    if (!division->knows(order)) throw SourceError("has changed since it was divided into parts");
    return division->part_of(order) == part;
  };
  source.keep_only(is_wanted, options.division->parts()[options.part - 1].features);
}

LoadedLayer load(FeatureSource& source, const LoadOptions& options, Clock::time_point start) {
  LoadedLayer loaded;
  if (options.division != nullptr) keep_part(source, options);
  TableReader table(source, options.selection);
  const unsigned threads = thread_count(options.threads);
  std::optional<EarlierLayer> earlier;
  if (can_take_over(options)) earlier.emplace(options.earlier);
  std::deque<FeatureBuilder> builders;
  for (unsigned i = 0; i < threads; ++i) {
    builders.emplace_back(options.generalization, earlier ? &*earlier : nullptr);
  }
  std::vector<FeatureWorker*> workers;
  workers.reserve(builders.size());
  for (FeatureBuilder& builder : builders) workers.push_back(&builder);
  const auto progress = [&options](double share) {
    if (options.progress) options.progress(share);
  };
  const auto building = [&progress](double share) {
    progress(share < 0 ? share : share * kPipelineShare);
  };
  const auto joining = [&progress](double share) {
    progress(kPipelineShare + share * (1 - kPipelineShare));
  };
  FeaturePipeline pipeline(source, options.generalization, workers, building,
                           earlier ? &*earlier : nullptr,
                           options.grid.empty() ? nullptr : find_target_grid(options.grid));
  pipeline.run([&table](SourceFeature& next) { return table.append(next); }, {});
  fill_report(pipeline, builders, source, options.division == nullptr || options.part == 1,
              loaded.report);
  loaded.layer = join_layer(builders, table.take_table(), joining, threads);
  warn_of_unknown_overlaps(*loaded.layer, loaded.report);
  progress(1);
  if (options.division != nullptr) {
    loaded.part =
        PartNumber{options.part, options.division->count(), options.division->fingerprint()};
  }
  loaded.report.read_seconds = seconds_between(start, pipeline.read_until());
  loaded.report.total_seconds = seconds_between(start, Clock::now());
  return loaded;
}

}  // namespace

LoadedLayer load_layer(const std::string& path, const LoadOptions& options) {
  const auto start = Clock::now();
  FeatureSource source(path, options.selection);
  try {
    LoadedLayer loaded = load(source, options, start);
    loaded.report.path = name_of_source(path);
    return loaded;
  } catch (const SourceError& error) {
    throw std::runtime_error(name_of_source(path) + ": " + error.what());
  }
}

}  // namespace trapeze
