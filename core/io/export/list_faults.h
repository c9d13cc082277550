// Writes the gaps and overlaps between the polygons of a source into a new file.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/io/load/load_report.h"

namespace trapeze {

struct FaultOptions {
  bool overwrite = false;  // replace an existing output
  unsigned threads = 0;    // 0: one per core
  /// As in LoadOptions.
  std::function<void(double)> progress = {};
};

struct FaultReport {
  std::size_t gaps = 0;
  std::size_t overlaps = 0;
  std::size_t unsearched = 0;  // features among which faults could not be searched
  /// For the first feature of each group in which faults could not be found, and for each skipped
  /// feature.
  std::vector<FeatureNote> notes;
};

/// Reads `source` like load_layer() and writes every gap and overlap of its features to `output`,
/// as found by find_faults() among features whose boxes intersect. Formats and errors are those of
/// export_layer(); the output is in degrees, in the order of the first feature of each fault. The
/// fields are `kind` ("gap" or "overlap"), `area` (square metres on the ground), `width` (metres:
/// the area over half of the boundary) and `features` (the ids in the source, separated by commas).
/// The output does not depend on the number of threads.
FaultReport list_faults(const std::string& source, const std::string& output,
                        const FaultOptions& options = {});

}  // namespace trapeze
