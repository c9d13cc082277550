#include "server/config/skip_limit.h"

#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <cstdint>

namespace trapeze {
namespace {

constexpr std::uint64_t kMostFeatures = std::uint64_t{1} << 53;  // exact as a double

template <typename Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

std::optional<SkipLimit> SkipLimit::parse(std::string_view text) {
  if (!text.ends_with('%')) {
    const auto features = number_in<std::uint64_t>(text);
    if (!features || *features > kMostFeatures) return std::nullopt;
    return SkipLimit(false, static_cast<double>(*features));
  }
  text.remove_suffix(1);
  if (text.ends_with(' ')) text.remove_suffix(1);
  const auto percent = number_in<double>(text);
  if (!percent || !(*percent >= 0 && *percent <= 100)) return std::nullopt;
  return SkipLimit(true, *percent);
}

std::string SkipLimit::text() const {
  if (is_share_) return fmt::format("{}%", most_);
  return fmt::format("{}", static_cast<std::uint64_t>(most_));
}

bool SkipLimit::allows(std::size_t skipped, std::size_t features) const {
  const auto count = static_cast<double>(skipped);
  return is_share_ ? 100 * count <= most_ * static_cast<double>(features) : count <= most_;
}

std::string find_excess(const LoadReport& report, SkipLimit limit) {
  if (limit.allows(report.skipped, report.features)) return {};
  return fmt::format(
      "{}: {} of {} features were skipped ({:.3g} %), and at most {} may be", report.path,
      report.skipped, report.features,
      100.0 * static_cast<double>(report.skipped) / static_cast<double>(report.features),
      limit.text());
}

}  // namespace trapeze
