// Where to part numbers into classes, by a rule.
//
// Breaks ascend, and a number is in the class above each break that it reaches. None is at or below
// the least number, or above the greatest: no class at an end is empty.
//
// Thread-safety: any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/name_table.h"
#include "server/values/value_spread.h"

namespace trapeze {

enum class BreakMethod : std::uint8_t {
  equal,     // classes of equal width
  jenks,     // the least sum of squared distances from the means of classes (Fisher, Jenks)
  pretty,    // at multiples of 1, 2 or 5 times a power of ten; about as many classes as are wanted
  quantile,  // as many numbers in each
  stddev,    // one standard deviation wide, from the mean on
};

inline constexpr NameTable<BreakMethod, 5> kBreakMethodNames({
    {"equal", BreakMethod::equal},
    {"jenks", BreakMethod::jenks},
    {"pretty", BreakMethod::pretty},
    {"quantile", BreakMethod::quantile},
    {"stddev", BreakMethod::stddev},
});

constexpr int kUsualClasses = 5;
constexpr int kMostRuledClasses = 32;

struct BreakRule {
  BreakMethod method = BreakMethod::quantile;
  int classes = kUsualClasses;  // wanted, 2 to kMostRuledClasses; of stddev without a meaning

  friend bool operator==(const BreakRule&, const BreakRule&) = default;
};

/// "quantile:5"; "quantile" is of kUsualClasses. Nothing for what is no rule.
std::optional<BreakRule> parse_break_rule(std::string_view text);
/// In full: "quantile:5", "stddev".
std::string break_rule_text(const BreakRule& rule);

/// None if all numbers are the same, or there are none; fewer than the rule wants if there are not
/// so many different numbers. Of more than kMostJenksValues different ones, jenks takes as many
/// groups of neighbours for the numbers, each as one at its mean; otherwise it is exact.
std::vector<double> class_breaks(const BreakRule& rule, const ValueSpread& spread);

constexpr std::size_t kMostJenksValues = 8192;

}  // namespace trapeze
