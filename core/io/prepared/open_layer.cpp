#include "core/io/prepared/open_layer.h"

#include <stdexcept>

#include "core/io/file/prepared_file.h"
#include "core/io/prepared/prepared_layer.h"

namespace trapeze {

LoadedLayer open_layer(const std::string& path, const OpenOptions& options) {
  if (is_prepared_file(path)) {
    if (!options.selection.is_all()) {
      throw std::runtime_error(path +
                               ": is prepared already; select from its source with the options of "
                               "`trapeze prepare`");
    }
    LoadedLayer layer = open_prepared_layer(
        path, {options.weights, options.prepared_from, options.coverage, options.close_gaps});
    if (options.progress) options.progress(1);
    return layer;
  }
  LoadOptions load;
  load.generalization.weights = options.weights.value_or(WeightRule::douglas_peucker);
  load.generalization.coverage = options.coverage.value_or(kUsualCoverage);
  load.generalization.close_gaps = options.close_gaps.value_or(0);
  if (load.generalization.close_gaps > 0 && load.generalization.coverage == CoverageMode::off) {
    throw std::runtime_error(path + ": gaps can be closed only where coverage is auto or on");
  }
  load.selection = options.selection;
  load.progress = options.progress;
  return load_layer(path, load);
}

}  // namespace trapeze
