// How many features of a layer may be skipped before that is an error.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/io/load/load_report.h"

namespace trapeze {

/// A number of features, or a share of all that the source has.
class SkipLimit {
 public:
  /// All of them.
  constexpr SkipLimit() = default;
  /// "12" or "0.5%", of 0 to 100 percent; nothing for any other text.
  static std::optional<SkipLimit> parse(std::string_view text);

  static constexpr std::string_view kTakes =
      "a number of features, or a share of them such as \"1%\"";

  /// As parse() takes it.
  std::string text() const;
  /// Whether that many of so many features may be skipped.
  bool allows(std::size_t skipped, std::size_t features) const;

  friend constexpr bool operator==(SkipLimit, SkipLimit) = default;

 private:
  constexpr SkipLimit(bool is_share, double most) : is_share_(is_share), most_(most) {}

  bool is_share_ = true;
  double most_ = 100;  // percent of a share; else features, a whole number
};

/// In words that name the file, that more of its features were skipped than may be; empty if not.
std::string find_excess(const LoadReport& report, SkipLimit limit);

}  // namespace trapeze
