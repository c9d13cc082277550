// Warnings about layers that are served nevertheless, in words.
#pragma once

#include <string>

#include "core/io/prepared/prepared_parts.h"
#include "core/layer/feature_table.h"

namespace trapeze {

/// That features lack the attribute that is to name them.
std::string without_title_words(const std::string& title_attribute);

/// The same if the features lack it; empty if not, or if no attribute is to name them.
std::string find_title_problem(const FeatureTable& features, const std::string& title_attribute);

/// A message if several parts lack their overview; empty if not.
std::string find_overview_problem(const PreparedParts& parts);

}  // namespace trapeze
