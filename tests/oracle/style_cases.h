// Styles for comparing pictures with the truth. Each is given as a query for the program and,
// written independently, as paints for the oracle.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/oracle/true_tile.h"

namespace trapeze::oracle {

struct StyleCase {
  std::string name;
  std::string query;  // without the question mark
  std::vector<TruePaint> paints;
  double line_width = 0;
  bool is_opaque = true;  // all its paints are: colours are not rounded twice
};

/// The attribute that determines the class of a feature, and its commonest values, one class each.
struct TrueClasses {
  std::string attribute;
  std::vector<std::string> values;  // the commonest first
};
TrueClasses classes_of(const TrueLayer& layer, const std::string& attribute);

/// The styles of one layer. The ids are those of the features to be highlighted; without ids there
/// is no such style.
std::vector<StyleCase> styles_of_layer(const TrueClasses& classes,
                                       const std::vector<std::int64_t>& ids);

/// The styles of two layers with those names.
std::vector<StyleCase> styles_of_pair(const std::string& lower, const std::string& upper);

}  // namespace trapeze::oracle
