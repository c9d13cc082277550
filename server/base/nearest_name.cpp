#include "server/base/nearest_name.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace trapeze {
namespace {

constexpr std::size_t kLettersASlip = 3;
constexpr std::size_t kLongestName = 64;  // longer text is not a mistyped name, and may be hostile

/// Edit distance in which swapping two neighbours counts once (optimal string alignment).
std::size_t slips_between(const std::string& a, const std::string& b) {
  using Row = std::vector<std::size_t>;  // by letter of b
  Row before(b.size() + 1);
  Row above(b.size() + 1);
  Row row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, changed});
      const bool is_swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (is_swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(above);
    above.swap(row);
  }
  return above[b.size()];
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view mistyped,
                                        const std::vector<std::string>& names) {
  if (mistyped.size() > kLongestName) return std::nullopt;
  const std::string given = in_lower_case(mistyped);
  std::optional<std::string> nearest;
  std::size_t fewest = std::max<std::size_t>(1, given.size() / kLettersASlip) + 1;
  for (const std::string& name : names) {
    const auto [shorter, longer] = std::minmax({given.size(), name.size()});
    if (longer - shorter >= fewest) continue;
    const std::size_t slips = slips_between(given, in_lower_case(name));
    if (slips >= fewest || slips >= name.size()) continue;
    fewest = slips;
    nearest = name;
  }
  return nearest;
}

std::string did_you_mean(std::string_view mistyped, const std::vector<std::string>& names) {
  const auto nearest = nearest_name(mistyped, names);
  return nearest ? "; did you mean " + *nearest + "?" : "";
}

std::string suggestion_or_stop(std::string_view mistyped, const std::vector<std::string>& names) {
  const auto nearest = nearest_name(mistyped, names);
  return nearest ? "; did you mean \"" + *nearest + "\"?" : ".";
}

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

}  // namespace trapeze
