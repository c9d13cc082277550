#include "server/data/fast_topology.h"

#include <fmt/format.h>

#include "core/io/prepared/prepared_parts.h"

namespace trapeze {

std::string find_topology_problem(const LayerConfig& layer) {
  if (!is_pattern_of_files(layer.file_to_open()) || !layer.has_fast_topology()) return {};
  return fmt::format(
      "{}: a layer in parts is not served with topology=fast, for which it would be built again",
      layer.file_to_open());
}

}  // namespace trapeze
