// How many features of a layer may be skipped before it is an error.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/io/load/load_report.h"

namespace trapeze {

/// A number of features, or a share of all features of the source.
class SkipLimit {
 public:
  /// All may be skipped.
  constexpr SkipLimit() = default;
  /// Parses "12" or "0.5%", with 0 to 100 percent; nothing for any other text.
  static std::optional<SkipLimit> parse(std::string_view text);

  static constexpr std::string_view kTakes =
      "a number of features, or a share of them such as \"1%\"";

  /// In the format of parse().
  std::string text() const;
  /// Whether `skipped` of `features` may be skipped.
  bool allows(std::size_t skipped, std::size_t features) const;

  friend constexpr bool operator==(SkipLimit, SkipLimit) = default;

 private:
  constexpr SkipLimit(bool is_share, double most) : is_share_(is_share), most_(most) {}

  bool is_share_ = true;
  double most_ = 100;  // percent for a share; otherwise a number of features, an integer
};

/// A message that names the file if too many of its features were skipped; empty if not.
std::string find_excess(const LoadReport& report, SkipLimit limit);

}  // namespace trapeze
