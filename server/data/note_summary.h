// Notes on features, made short enough for a log.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/io/load/load_report.h"

namespace trapeze {

/// One line for each sort of note, which its words before the first colon tell, in the order of the
/// first of each: "features 4, 7, 9 and 80 more: repaired: its rings cross or touch". Where the
/// words after the colon differ, those of the first feature are given. Any thread.
std::vector<std::string> summarize_notes(std::span<const FeatureNote> notes);

}  // namespace trapeze
