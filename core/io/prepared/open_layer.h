// A layer of a file, whatever it is: a source of polygons, or a layer prepared from one.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/io/load/load_layer.h"

namespace trapeze {

struct OpenOptions {
  std::optional<WeightRule> weights = {};  // unset: those of a prepared layer, else Douglas-Peucker
  SourceSelection selection = {};          // of a source; a prepared layer has been selected from
  std::string prepared_from =
      {};  // the source of a prepared layer, where it is now; empty: as it says
  std::function<void(double)> progress = {};  // see LoadOptions
  std::optional<CoverageMode> coverage =
      {};                                 // unset: that of a prepared layer, else kUsualCoverage
  std::optional<double> close_gaps = {};  // metres; unset: that of a prepared layer, else 0
  std::optional<double> merge = {};       // pixels; unset: that of a prepared layer, else 0
  std::string merge_by = {};  // of features by which attribute; empty: as a layer was prepared
  std::string grid = {};      // see LoadOptions
  std::shared_ptr<const Layer> earlier = {};  // see LoadOptions; of no use to a prepared layer
  std::shared_ptr<const PreparedParts> earlier_parts = {};  // see open_prepared_parts()
};

/// What of the options a finding is about, or the file itself.
enum class OpenPart { file, layer, where, attributes, close_gaps, merge, merge_by };

/// What is found out about a layer before it is read.
struct OpenFinding {
  OpenPart part = OpenPart::file;
  std::size_t index = 0;    // of attributes: which of them
  std::string what;         // names the file
  bool is_warning = false;  // open_layer() opens it all the same, and warns in its report
};

/// All that would keep open_layer() from opening the layer, and all of which it would warn, as far
/// as it can be known without reading the source: it is opened, and asked for its layers,
/// attributes, reference systems and extent. A prepared file is mapped and checked. Never throws
/// for what is wrong. Thread-safety: any thread.
std::vector<OpenFinding> examine_layer(const std::string& path, const OpenOptions& options = {});

/// Maps a prepared file, which is known by its first bytes, or loads a source. A pattern of files
/// is a layer in several prepared parts, see open_prepared_parts(). Throws as
/// open_prepared_layer() and load_layer() do. Thread-safety: any thread.
LoadedLayer open_layer(const std::string& path, const OpenOptions& options = {});

}  // namespace trapeze
