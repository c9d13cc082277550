#include "core/grid/plate_carree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/grid/web_mercator.h"

namespace trapeze {
namespace {

// Keeps the poles finite, far outside the square.
constexpr double kNearPole = std::numbers::pi / 2 - 1e-9;

// Between the entries of a table, the projection is approximated by a cubic polynomial with the
// same values and slopes. The error is at most h^4 / 384 times the greatest fourth derivative,
// which is less than 5. With h = 2^19 cells, or 0.0015 radians, that is less than 0.0001 cells.
constexpr int kStepBits = 19;
constexpr std::int64_t kStep = std::int64_t{1} << kStepBits;
constexpr std::size_t kSteps = static_cast<std::size_t>(kGridSize / kStep);

struct PlaceOfTable {
  double row = 0;
  double slope = 0;  // rows per step
};

const std::vector<PlaceOfTable>& table() {
  static const std::vector<PlaceOfTable> places = [] {
    std::vector<PlaceOfTable> made(kSteps + 1);
    for (std::size_t i = 0; i <= kSteps; ++i) {
      const double y = kGridMin + static_cast<double>(i) * static_cast<double>(kStep);
      made[i] = {plate_carree_from_mercator(y), static_cast<double>(kStep) / mercator_stretch(y)};
    }
    return made;
  }();
  return places;
}

}  // namespace

std::int32_t plate_carree_row(std::int32_t y) {
  static const PlaceOfTable* const places = table().data();
  const std::int64_t from_north = std::int64_t{y} - kGridMin;
  const auto step = std::min(static_cast<std::size_t>(from_north >> kStepBits), kSteps - 1);
  const double t =
      static_cast<double>(from_north - (static_cast<std::int64_t>(step) << kStepBits)) /
      static_cast<double>(kStep);
  const PlaceOfTable& a = places[step];
  const PlaceOfTable& b = places[step + 1];
  const double rise = b.row - a.row;
  const double row =
      a.row +
      t * (a.slope + t * (3 * rise - 2 * a.slope - b.slope + t * (a.slope + b.slope - 2 * rise)));
  return static_cast<std::int32_t>(std::lround(row));
}

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
