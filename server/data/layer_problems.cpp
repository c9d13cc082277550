#include "server/data/layer_problems.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "core/io/file/prepared_file.h"
#include "core/io/prepared/open_layer.h"
#include "core/io/prepared/prepared_parts.h"
#include "core/io/source/change_feed.h"
#include "server/data/dataset.h"
#include "server/data/fast_topology.h"

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

/// A message if a prepared layer has too many skipped features; empty if not.
std::string find_prepared_excess(const LayerConfig& layer) {
  const std::string& file = layer.file_to_open();
  if (!is_pattern_of_files(file) && !is_prepared_file(file)) return {};
  return find_excess(open_layer(file, how_to_open(layer)).report, layer.max_skipped);
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
  if (!problems.empty()) return problems;  // a prepared file has no warnings
  std::string excess = find_prepared_excess(layer);
  if (!excess.empty()) problems.push_back({"max_skipped", std::nullopt, std::move(excess), false});
  return problems;
}

}  // namespace trapeze
