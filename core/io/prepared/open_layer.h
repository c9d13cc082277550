// A layer of a file, whatever it is: a source of polygons, or a layer prepared from one.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/io/load/load_layer.h"

namespace trapeze {

struct OpenOptions {
  std::optional<WeightRule> weights;  // unset: those of a prepared layer, else Douglas-Peucker
  SourceSelection selection;          // of a source; a prepared layer has been selected from
  std::string prepared_from;  // the source of a prepared layer, where it is now; empty: as it says
  std::function<void(double)> progress = {};  // see LoadOptions
  std::optional<CoverageMode> coverage =
      {};                                 // unset: that of a prepared layer, else kUsualCoverage
  std::optional<double> close_gaps = {};  // metres; unset: that of a prepared layer, else 0
};

/// Maps a prepared file, which is known by its first bytes, or loads a source. Throws as
/// open_prepared_layer() and load_layer() do. Thread-safety: any thread.
LoadedLayer open_layer(const std::string& path, const OpenOptions& options = {});

}  // namespace trapeze
