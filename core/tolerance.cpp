#include "core/tolerance.h"

#include <algorithm>
#include <cmath>

namespace trapeze {

double epsilon_of_level(Level level) {
  if (level == 0) return 0;
  return std::exp2((level - 1) / static_cast<double>(kLevelsPerOctave) + kFirstExponent);
}

Level level_of_epsilon(double epsilon) {
  if (!(epsilon >= epsilon_of_level(1))) return 0;
  const double steps = (std::log2(epsilon) - kFirstExponent) * kLevelsPerOctave;
  int level = std::clamp(static_cast<int>(std::floor(steps)) + 1, 1, static_cast<int>(kLastLevel));
  // The logarithm is rounded; the definition is in terms of the tolerances themselves.
  while (level > 1 && epsilon_of_level(static_cast<Level>(level)) > epsilon) --level;
  while (level < kLastLevel && epsilon_of_level(static_cast<Level>(level + 1)) <= epsilon) ++level;
  return static_cast<Level>(level);
}

}  // namespace trapeze
