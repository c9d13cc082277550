#include "core/grid/tolerance.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace trapeze {
namespace {

/// The number of levels above level 1, not yet rounded.
double steps(double epsilon) {
  return (std::log2(epsilon) - kFirstExponent) * kLevelsPerOctave;
}

std::array<double, kLastLevel + 1> epsilons_of_levels() {
  std::array<double, kLastLevel + 1> epsilons{};
  for (int k = 1; k <= kLastLevel; ++k) {
    epsilons[static_cast<std::size_t>(k)] =
        std::exp2((k - 1) / static_cast<double>(kLevelsPerOctave) + kFirstExponent);
  }
  return epsilons;
}

const std::array<double, kLastLevel + 1> kEpsilons = epsilons_of_levels();

}  // namespace

double epsilon_of_level(Level level) {
  return kEpsilons[level];
}

Level nearest_level(double epsilon) {
  // At quarters of a zoom, usual tolerances lie in the middle between two levels. Windows side by
  // side, whose pixels differ by their rounding, must get the same one.
  constexpr double kBeyondRounding = 1.0 / 256;
  const double place = epsilon > 0 ? steps(epsilon) + kBeyondRounding : -1;
  // More than half a step below the first level.
  if (place < -0.5) return 0;
  return static_cast<Level>(
      std::clamp(static_cast<int>(std::lround(place)) + 1, 1, int{kLastLevel}));
}

int level_above(double epsilon) {
  return static_cast<int>(std::upper_bound(kEpsilons.begin() + 1, kEpsilons.end(), epsilon) -
                          kEpsilons.begin());
}

}  // namespace trapeze
