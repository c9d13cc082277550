// Shortens notes on features for a log.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/io/load/load_report.h"

namespace trapeze {

/// One line for each kind of note, which is identified by its text before the first colon, in order
/// of first occurrence: "features 4, 7, 9 and 80 more: repaired: its rings cross or touch". If the
/// texts after the colon differ, that of the first feature is shown. Any thread.
std::vector<std::string> summarize_notes(std::span<const FeatureNote> notes);

}  // namespace trapeze
