// Numbers as people read them: in legends.
//
// Thread-safety: any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace trapeze {

/// A part of what d3-format takes: [,][.DIGITS][TYPE], such as ",.1f", ".0%", ".3s" or ",".
struct NumberFormat {
  bool has_groups = false;    // "," between each three digits
  std::optional<int> digits;  // 0 to 9: after the point; of SI, significant ones
  enum class Type : std::uint8_t {
    fixed,    // "f", or nothing
    percent,  // "%": a hundred times as much, with the sign
    si,       // "s": with the prefix of a power of a thousand, "12.3M"
  } type = Type::fixed;

  friend bool operator==(const NumberFormat&, const NumberFormat&) = default;
};

/// Nothing for what is no format.
std::optional<NumberFormat> parse_number_format(std::string_view text);
/// Reads back as the same.
std::string number_format_text(const NumberFormat& format);

/// `number` is finite. Without digits, as many as it takes to tell it from all others, but six
/// after the point at most.
std::string formatted(double number, const NumberFormat& format);

/// For numbers that are `step` > 0 apart: with groups, and as many digits as tell them apart.
NumberFormat format_for_step(double step);

}  // namespace trapeze
