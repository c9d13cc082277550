#include "server/data/layer_problems.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <utility>

#include "core/io/file/prepared_file.h"
#include "core/io/prepared/open_layer.h"
#include "core/io/prepared/prepared_parts.h"
#include "core/io/source/change_feed.h"
#include "core/io/source/source_name.h"
#include "server/data/dataset.h"
#include "server/data/fast_topology.h"
#include "server/data/layer_warnings.h"

namespace trapeze {
namespace {

const char* key_of(OpenPart part, const LayerConfig& layer) {
  switch (part) {
    case OpenPart::layer:
      return "source_layer";
    case OpenPart::where:
      return "where";
    case OpenPart::attributes:
      return "attributes";
    case OpenPart::close_gaps:
      return "close_gaps";
    case OpenPart::merge:
      return "merge";
    case OpenPart::merge_by:
      return "merge_by";
    case OpenPart::file:
      break;
  }
  return layer.prepared.empty() ? "file" : "prepared";
}

bool is_prepared(const LayerConfig& layer) {
  return is_pattern_of_files(layer.file_to_open()) || is_prepared_file(layer.file_to_open());
}

/// The problems of a prepared layer that can be opened.
std::vector<LayerProblem> find_prepared_problems(const LayerConfig& layer) {
  const LoadedLayer loaded = open_layer(layer.file_to_open(), how_to_open(layer));
  const std::string name = name_of_source(layer.file_to_open()) + ": ";
  const char* file = key_of(OpenPart::file, layer);
  std::vector<LayerProblem> problems;
  if (std::string excess = find_excess(loaded.report, layer.max_skipped); !excess.empty()) {
    problems.push_back({"max_skipped", std::nullopt, std::move(excess), false});
  }
  for (const std::string& warning : loaded.report.warnings) {
    problems.push_back({file, std::nullopt, name + warning, true});
  }
  if (loaded.parts != nullptr) {
    const std::string overview = find_overview_problem(*loaded.parts);
    if (!overview.empty()) problems.push_back({file, std::nullopt, name + overview, true});
  }
  const std::string title = find_title_problem(loaded.layer->features(), layer.title_attribute);
  if (!title.empty()) problems.push_back({"title_attribute", std::nullopt, name + title, true});
  return problems;
}

/// Whether a source that can be opened lacks the attribute that is to name its features.
bool lacks_title(const LayerConfig& layer) {
  if (layer.title_attribute.empty()) return false;
  OpenOptions options = how_to_open(layer);
  auto& kept = options.selection.attributes;
  if (kept) return std::ranges::find(*kept, layer.title_attribute) == kept->end();
  kept = {layer.title_attribute};
  const std::vector<OpenFinding> findings = examine_layer(layer.file_to_open(), options);
  return std::ranges::any_of(
      findings, [](const OpenFinding& finding) { return finding.part == OpenPart::attributes; });
}

/// A message if the changes of a live layer cannot be queried; empty if they can.
std::string find_live_problem(const LayerConfig& layer) {
  if (layer.live_query.empty()) return {};
  try {
    const ChangeFeed feed(layer.file, layer.live_query);
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace

std::vector<LayerProblem> find_layer_problems(const LayerConfig& layer) {
  std::vector<LayerProblem> problems;
  for (OpenFinding& found : examine_layer(layer.file_to_open(), how_to_open(layer))) {
    const auto index =
        found.part == OpenPart::attributes ? std::optional(found.index) : std::nullopt;
    problems.push_back({key_of(found.part, layer), index, std::move(found.what), found.is_warning});
  }
  if (std::ranges::all_of(problems, &LayerProblem::is_warning)) {
    std::string live = find_live_problem(layer);
    if (!live.empty()) problems.push_back({"live_query", std::nullopt, std::move(live), false});
  }
  if (std::string topology = find_topology_problem(layer); !topology.empty()) {
    const char* key = layer.fast_topology ? "fast_topology" : "style";
    problems.push_back({key, std::nullopt, std::move(topology), false});
  }
  if (!std::ranges::all_of(problems, &LayerProblem::is_warning)) return problems;
  if (is_prepared(layer)) {
    std::ranges::move(find_prepared_problems(layer), std::back_inserter(problems));
  } else if (lacks_title(layer)) {
    problems.push_back(
        {"title_attribute", std::nullopt,
         name_of_source(layer.file_to_open()) + ": " + without_title_words(layer.title_attribute),
         true});
  }
  return problems;
}

}  // namespace trapeze
