// Writes the gaps and overlaps between the polygons of a source into a file of their own.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/io/load/load_report.h"

namespace trapeze {

struct FaultOptions {
  bool overwrite = false;  // replace an output that exists
  unsigned threads = 0;    // 0: one a core
  /// As in LoadOptions.
  std::function<void(double)> progress = {};
};

struct FaultReport {
  std::size_t gaps = 0;
  std::size_t overlaps = 0;
  std::size_t unsearched = 0;  // features among which they could not be found
  /// For the first feature of those among which faults could not be found, and for each that was
  /// skipped.
  std::vector<FeatureNote> notes;
};

/// Reads `source` as load_layer() does, and writes every place where its features do not fit
/// together, as find_faults() finds them among those whose boxes meet, to `output`: in the formats
/// and with the errors of export_layer(), in degrees, in the order of the first feature of each.
/// The fields are `kind` ("gap" or "overlap"), `area` (square metres on the ground), `width`
/// (metres: the area over half of the boundary) and `features` (the ids in the source, with commas
/// between them). The output does not depend on the number of threads.
FaultReport list_faults(const std::string& source, const std::string& output,
                        const FaultOptions& options = {});

}  // namespace trapeze
