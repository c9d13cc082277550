// Opens a layer from a file of either kind: a source of polygons, or a layer prepared from one.
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
  std::optional<WeightRule> weights = {};  // unset: as the layer was prepared, else Douglas-Peucker
  SourceSelection selection = {};          // from a source; a prepared layer already contains a
                                           // selection
  std::string prepared_from =
      {};  // the present path of the source of a prepared layer; empty: the path it records
  std::function<void(double)> progress = {};  // see LoadOptions
  std::optional<CoverageMode> coverage =
      {};                                 // unset: as the layer was prepared, else kUsualCoverage
  std::optional<double> close_gaps = {};  // metres; unset: as the layer was prepared, else 0
  std::optional<double> merge = {};       // pixels; unset: as the layer was prepared, else 0
  std::string merge_by = {};  // attribute by which features are merged; empty: as the layer was
                              // prepared
  std::string grid = {};      // see LoadOptions
  std::shared_ptr<const Layer> earlier = {};  // see LoadOptions; not used for a prepared layer
  std::shared_ptr<const PreparedParts> earlier_parts = {};  // see open_prepared_parts()
};

/// The option that a finding is about, or the file itself.
enum class OpenPart { file, layer, where, attributes, close_gaps, merge, merge_by };

/// A finding about a layer, made before it is read.
struct OpenFinding {
  OpenPart part = OpenPart::file;
  std::size_t index = 0;    // for attributes: which of them
  std::string what;         // message that names the file
  bool is_warning = false;  // open_layer() opens the layer nevertheless, and warns in its report
};

/// Finds every reason for which open_layer() would fail or warn, as far as it can be known without
/// reading the source. The source is opened and queried for its layers, attributes, reference
/// systems and extent. A prepared file is mapped and checked. Never throws because of such
/// problems. Thread-safety: may be called from any thread.
std::vector<OpenFinding> examine_layer(const std::string& path, const OpenOptions& options = {});

/// Maps a prepared file, which is recognized by its first bytes, or loads a source. A file name
/// pattern is a layer in several prepared parts, see open_prepared_parts(). Throws like
/// open_prepared_layer() and load_layer(). Thread-safety: may be called from any thread.
LoadedLayer open_layer(const std::string& path, const OpenOptions& options = {});

}  // namespace trapeze
