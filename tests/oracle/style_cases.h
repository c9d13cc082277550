// Styles that pictures are held to the truth in: each as a query for the program and as paints for
// the oracle, written apart.
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
  bool is_opaque = true;  // every paint of it: colours are not rounded twice
};

/// By which attribute features are told apart, and how: the commonest values, one class each.
struct TrueClasses {
  std::string attribute;
  std::vector<std::string> values;  // the commonest first
};
TrueClasses classes_of(const TrueLayer& layer, const std::string& attribute);

/// The styles of one layer. The ids are of features to be highlighted; without any there is no
/// such style.
std::vector<StyleCase> styles_of_layer(const TrueClasses& classes,
                                       const std::vector<std::int64_t>& ids);

/// The styles of two layers of those names.
std::vector<StyleCase> styles_of_pair(const std::string& lower, const std::string& upper);

}  // namespace trapeze::oracle
