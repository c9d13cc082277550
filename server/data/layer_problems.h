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
};

/// All that would keep Dataset::load() from loading the layer, as far as it can be known without
/// reading its source, see find_open_problems(); of a prepared layer, that more of it was skipped
/// than may be, too. Never throws for what is wrong. Thread-safety: any thread.
std::vector<LayerProblem> find_layer_problems(const LayerConfig& layer);

}  // namespace trapeze
