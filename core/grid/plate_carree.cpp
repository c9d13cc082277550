#include "core/grid/plate_carree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace trapeze {
namespace {

constexpr double kCellsPerRadian = static_cast<double>(kGridMax) / std::numbers::pi;
// Keeps the poles finite, far outside of the square.
constexpr double kNearPole = std::numbers::pi / 2 - 1e-9;

}  // namespace

double plate_carree_from_mercator(double y) {
  return std::atan(std::sinh(y / kCellsPerRadian)) * kCellsPerRadian;
}

double mercator_from_plate_carree(double y) {
  const double latitude = std::clamp(y / kCellsPerRadian, -kNearPole, kNearPole);
  return std::asinh(std::tan(latitude)) * kCellsPerRadian;
}

double mercator_stretch(double y) {
  return std::cosh(y / kCellsPerRadian);
}

std::int64_t straight_height(double most) {
  const double height = std::sqrt(16 * kCellsPerRadian * most);
  const double least = std::clamp(height, 1.0, static_cast<double>(kGridSize));
  return static_cast<std::int64_t>(std::bit_floor(static_cast<std::uint64_t>(least)));
}

}  // namespace trapeze
