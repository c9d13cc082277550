// Finds problems in the configuration of a layer without loading it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "server/config/config.h"

namespace trapeze {

struct LayerProblem {
  std::string key;                   // of the setting: "file"
  std::optional<std::size_t> index;  // of the item, if the setting is a list
  std::string what;
  bool is_warning = false;  // it is loaded nevertheless, with a warning in the log
};

/// Finds everything that would make Dataset::load() fail or warn for the layer, as far as it can be
/// known without reading its source, see examine_layer(). For a prepared layer this includes too
/// many skipped features. Reports problems instead of throwing. Thread-safety: any thread.
std::vector<LayerProblem> find_layer_problems(const LayerConfig& layer);

}  // namespace trapeze
