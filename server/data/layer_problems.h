// What is wrong with the configuration of a layer, without loading it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "server/config/config.h"

namespace trapeze {

struct LayerProblem {
  std::string key;                   // of the setting: "file"
  std::optional<std::size_t> index;  // of a list: which item of it
  std::string what;
  bool is_warning = false;  // it is loaded all the same, and the log warns
};

/// All that would keep Dataset::load() from loading the layer, or make it warn, as far as it can be
/// known without reading its source, see examine_layer(); of a prepared layer, that more of it was
/// skipped than may be, too. Never throws for what is wrong. Thread-safety: any thread.
std::vector<LayerProblem> find_layer_problems(const LayerConfig& layer);

}  // namespace trapeze
