#include "core/borders/coverage_options.h"

#include <algorithm>

namespace trapeze {

std::vector<std::uint32_t> numbered(std::span<const std::uint64_t> classes) {
  std::vector<std::uint64_t> known(classes.begin(), classes.end());
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  std::vector<std::uint32_t> numbers;
  numbers.reserve(classes.size());
  for (const std::uint64_t own : classes) {
    const auto at = std::lower_bound(known.begin(), known.end(), own);
    numbers.push_back(static_cast<std::uint32_t>(at - known.begin()));
  }
  return numbers;
}

}  // namespace trapeze
