#include "core/io/prepared/open_layer.h"

#include <stdexcept>
#include <utility>

#include "core/io/file/prepared_file.h"
#include "core/io/prepared/prepared_layer.h"
#include "core/io/prepared/prepared_parts.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/merge_classes.h"
#include "core/io/source/source_name.h"

namespace trapeze {
namespace {

/// Warns if a single part is served because a shell has expanded the pattern to all file names.
LoadedLayer open_single(const std::string& path, const PreparedDemands& demands) {
  LoadedLayer loaded = open_prepared_layer(path, demands);
  if (!loaded.part) return loaded;
  const std::string parts = std::to_string(loaded.part->count) + " parts of a layer";
  loaded.report.warnings.push_back(
      (loaded.part->is_overview()
           ? "is the overview of the " + parts
           : "is number " + std::to_string(loaded.part->number) + " of the " + parts) +
      ", by itself; all of them are one layer under a name with a *, in quotes on a command line");
  return loaded;
}

LoadedLayer open_prepared(const std::string& path, const OpenOptions& options) {
  if (!options.selection.is_all()) {
    throw std::runtime_error(path +
                             ": is prepared already; select from its source with the options of "
                             "`trapeze prepare`");
  }
  const auto merge_by = options.merge_by.empty() ? std::nullopt : std::optional(options.merge_by);
  const PreparedDemands demands = {
      options.weights, options.prepared_from, options.coverage, options.close_gaps,
      options.grid,    options.merge,         merge_by};
  if (!is_pattern_of_files(path)) return open_single(path, demands);
  LoadedLayer loaded =
      open_prepared_parts(files_of_pattern(path), demands, options.earlier_parts.get());
  loaded.report.path = path;
  return loaded;
}

bool is_prepared(const std::string& path) {
  return is_pattern_of_files(path) || is_prepared_file(path);
}

LayerOptions layer_options(const OpenOptions& options) {
  LayerOptions layer;
  layer.weights = options.weights.value_or(WeightRule::douglas_peucker);
  layer.coverage = options.coverage.value_or(kUsualCoverage);
  layer.close_gaps = options.close_gaps.value_or(0);
  layer.merge = options.merge.value_or(0);
  layer.merge_by = options.merge_by;
  return layer;
}

/// A message that gaps would be closed where no borders are shared; empty if that is not the case.
std::string find_idle_gaps(const std::string& path, const LayerOptions& layer) {
  if (layer.close_gaps == 0 || layer.coverage != CoverageMode::off) return {};
  return name_of_source(path) + ": gaps can be closed only where coverage is auto or on";
}

/// The same for blocks.
std::string find_idle_merge(const std::string& path, const LayerOptions& layer) {
  if (layer.merge == 0 || layer.coverage != CoverageMode::off) return {};
  return name_of_source(path) + ": polygons become blocks only where coverage is auto or on";
}

/// A message that there are merge classes without merging.
std::string find_idle_classes(const std::string& path, const LayerOptions& layer) {
  if (layer.merge_by.empty() || layer.merge > 0) return {};
  return name_of_source(path) + ": polygons become blocks by \"" + layer.merge_by +
         "\" only where it is said how near they are to each other, by merge";
}

OpenPart part_of(SelectionPart part) {
  switch (part) {
    case SelectionPart::layer:
      return OpenPart::layer;
    case SelectionPart::where:
      return OpenPart::where;
    case SelectionPart::attributes:
      return OpenPart::attributes;
  }
  return OpenPart::file;
}

/// Throws if something is wrong with a source.
void examine_source(const std::string& path, const OpenOptions& options,
                    std::vector<OpenFinding>& findings) {
  const std::string name = name_of_source(path);
  const FeatureSource source(path, options.selection);
  try {
    const MergeClasses classes(source, options.merge_by);
  } catch (const SourceError& error) {
    findings.push_back({OpenPart::merge_by, 0, name + ": " + error.what()});
  }
  try {
    source.check_reference_systems();
  } catch (const SourceError& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
  for (const std::string& warning : source.warnings()) {
    std::string words = name;
    words.append(": ").append(warning);
    findings.push_back({OpenPart::file, 0, std::move(words), true});
  }
}

}  // namespace

std::vector<OpenFinding> examine_layer(const std::string& path, const OpenOptions& options) {
  std::vector<OpenFinding> findings;
  try {
    if (is_prepared(path)) {
      open_prepared(path, options);
      return findings;
    }
    const std::string idle_gaps = find_idle_gaps(path, layer_options(options));
    if (!idle_gaps.empty()) findings.push_back({OpenPart::close_gaps, 0, idle_gaps});
    const std::string idle_merge = find_idle_merge(path, layer_options(options));
    if (!idle_merge.empty()) findings.push_back({OpenPart::merge, 0, idle_merge});
    const std::string idle_classes = find_idle_classes(path, layer_options(options));
    if (!idle_classes.empty()) findings.push_back({OpenPart::merge_by, 0, idle_classes});
    examine_source(path, options, findings);
  } catch (const SelectionError& error) {
    for (const SelectionProblem& problem : error.problems()) {
      findings.push_back(
          {part_of(problem.part), problem.index, name_of_source(path) + ": " + problem.what});
    }
  } catch (const std::exception& error) {
    findings.push_back({OpenPart::file, 0, error.what()});
  }
  return findings;
}

LoadedLayer open_layer(const std::string& path, const OpenOptions& options) {
  if (is_prepared(path)) {
    LoadedLayer layer = open_prepared(path, options);
    if (options.progress) options.progress(1);
    return layer;
  }
  LoadOptions load;
  load.generalization = layer_options(options);
  const std::string idle_gaps = find_idle_gaps(path, load.generalization);
  if (!idle_gaps.empty()) throw std::runtime_error(idle_gaps);
  const std::string idle_merge = find_idle_merge(path, load.generalization);
  if (!idle_merge.empty()) throw std::runtime_error(idle_merge);
  const std::string idle_classes = find_idle_classes(path, load.generalization);
  if (!idle_classes.empty()) throw std::runtime_error(idle_classes);
  load.selection = options.selection;
  load.progress = options.progress;
  load.earlier = options.earlier;
  load.grid = options.grid;
  return load_layer(path, load);
}

}  // namespace trapeze
