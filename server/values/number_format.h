// Formats numbers for people, for example in legends.
//
// Thread-safety: any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace trapeze {

/// A subset of d3-format: [,][.DIGITS][TYPE], such as ",.1f", ".0%", ".3s" or ",".
struct NumberFormat {
  bool has_groups = false;    // "," between groups of three digits
  std::optional<int> digits;  // 0 to 9: decimals; for SI, significant digits
  enum class Type : std::uint8_t {
    fixed,    // "f", or empty
    percent,  // "%": multiplied by 100, with a percent sign
    si,       // "s": with an SI prefix, "12.3M"
  } type = Type::fixed;

  friend bool operator==(const NumberFormat&, const NumberFormat&) = default;
};

/// Nothing if the text is not a valid format.
std::optional<NumberFormat> parse_number_format(std::string_view text);
/// Text that is parsed as the same format.
std::string number_format_text(const NumberFormat& format);

/// `number` must be finite. Without digits, writes as many as needed to distinguish it from all
/// other numbers, but at most six decimals.
std::string formatted(double number, const NumberFormat& format);

/// A format for numbers that are `step` > 0 apart: with groups, and as many digits as needed to
/// distinguish them.
NumberFormat format_for_step(double step);

}  // namespace trapeze
