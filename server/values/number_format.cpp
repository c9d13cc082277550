#include "server/values/number_format.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace trapeze {
namespace {

constexpr int kMostDigits = 9;
constexpr int kUsualDigits = 6;
constexpr double kGreatestFixed = 1e21;  // from here on, decimals carry no information

/// "1234567.5" becomes "1,234,567.5".
std::string with_groups(std::string text) {
  constexpr std::size_t kGroup = 3;
  const std::size_t begin = text.starts_with('-') ? 1 : 0;
  const std::size_t point = std::min(text.find('.'), text.size());
  for (std::size_t end = point; end > begin + kGroup;) {
    end -= kGroup;
    text.insert(end, ",");
  }
  return text;
}

std::string without_zeros(std::string text) {
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

/// Removes the sign of negative zero.
std::string without_sign_of_zero(std::string text) {
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  if (is_zero && text.starts_with('-')) text.erase(0, 1);
  return text;
}

std::string fixed(double number, const NumberFormat& format) {
  if (std::abs(number) >= kGreatestFixed) return fmt::format("{:.6g}", number);
  std::string text = format.digits ? fmt::format("{:.{}f}", number, *format.digits)
                                   : without_zeros(fmt::format("{:.{}f}", number, kUsualDigits));
  text = without_sign_of_zero(std::move(text));
  return format.has_groups ? with_groups(std::move(text)) : text;
}

std::string si(double number, const NumberFormat& format) {
  constexpr std::array<std::string_view, 11> kPrefixes = {"p", "n", "µ", "m", "", "k",
                                                          "M", "G", "T", "P", "E"};
  constexpr int kFirst = -4;  // as a power of 1000
  constexpr int kLast = 6;
  if (number == 0) return "0";
  const int significant = std::max(format.digits.value_or(3), 1);
  // Determined by the rounded number: 999,999 is 1.00M, and with two digits 123,456 is 120k.
  const std::string rounded = fmt::format("{:.{}e}", number, significant - 1);
  std::from_chars(rounded.data(), rounded.data() + rounded.size(), number);
  const int exponent = std::stoi(rounded.substr(rounded.find('e') + 1));
  const int power = std::clamp(static_cast<int>(std::floor(exponent / 3.0)), kFirst, kLast);
  const double scaled = number / std::pow(1000.0, power);
  const int decimals = std::clamp(significant - 1 - (exponent - 3 * power), 0, kMostDigits);
  std::string text = fmt::format("{:.{}f}", scaled, decimals);
  if (!format.digits) text = without_zeros(std::move(text));
  return without_sign_of_zero(std::move(text)) + std::string(kPrefixes[power - kFirst]);
}

}  // namespace

std::optional<NumberFormat> parse_number_format(std::string_view text) {
  if (text.empty()) return std::nullopt;
  NumberFormat format;
  if (text.starts_with(',')) {
    format.has_groups = true;
    text.remove_prefix(1);
  }
  if (text.starts_with('.')) {
    if (text.size() < 2 || text[1] < '0' || text[1] > '0' + kMostDigits) return std::nullopt;
    format.digits = text[1] - '0';
    text.remove_prefix(2);
  }
  if (text.empty() || text == "f") return format;
  if (text == "%") {
    format.type = NumberFormat::Type::percent;
  } else if (text == "s" && !format.has_groups) {
    format.type = NumberFormat::Type::si;
  } else {
    return std::nullopt;
  }
  return format;
}

std::string number_format_text(const NumberFormat& format) {
  std::string text = format.has_groups ? "," : "";
  if (format.digits) text += fmt::format(".{}", *format.digits);
  switch (format.type) {
    case NumberFormat::Type::fixed:
      return text + "f";
    case NumberFormat::Type::percent:
      return text + "%";
    case NumberFormat::Type::si:
      return text + "s";
  }
  return text;
}

std::string formatted(double number, const NumberFormat& format) {
  switch (format.type) {
    case NumberFormat::Type::percent:
      return fixed(100 * number, format) + "%";
    case NumberFormat::Type::si:
      return si(number, format);
    case NumberFormat::Type::fixed:
      break;
  }
  return fixed(number, format);
}

NumberFormat format_for_step(double step) {
  NumberFormat format;
  format.has_groups = true;
  // Two significant digits of the step.
  const double digits = 1 - std::floor(std::log10(step));
  format.digits = static_cast<int>(std::clamp(digits, 0.0, static_cast<double>(kMostDigits)));
  return format;
}

}  // namespace trapeze
