// Divides numbers into classes by a rule.
//
// Breaks are ascending, and a number is in the class above each break that it reaches. No break is
// at or below the least number, or above the greatest, so the classes at the ends are not empty.
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
  jenks,     // minimal sum of squared distances from class means (Fisher, Jenks)
  pretty,    // at multiples of 1, 2 or 5 times a power of ten; the number of classes is approximate
  quantile,  // the same number of values in each class
  stddev,    // one standard deviation wide, starting at the mean
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
  int classes = kUsualClasses;  // requested, 2 to kMostRuledClasses; ignored for stddev

  friend bool operator==(const BreakRule&, const BreakRule&) = default;
};

/// Parses "quantile:5"; "quantile" alone means kUsualClasses. Nothing for invalid text.
std::optional<BreakRule> parse_break_rule(std::string_view text);
/// The full form: "quantile:5", "stddev".
std::string break_rule_text(const BreakRule& rule);

/// Empty if all numbers are equal, or there are none; fewer than the rule requests if there are not
/// enough distinct numbers. With more than kMostJenksValues distinct numbers, jenks replaces them
/// by that many groups of neighbours, each of which counts as its mean; otherwise it is exact.
std::vector<double> class_breaks(const BreakRule& rule, const ValueSpread& spread);

constexpr std::size_t kMostJenksValues = 8192;

}  // namespace trapeze
