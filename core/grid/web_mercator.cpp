#include "core/grid/web_mercator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trapeze {
namespace {

constexpr double kCellsPerMetre = static_cast<double>(kGridMax) / kMercatorHalfSide;
constexpr double kDegree = std::numbers::pi / 180.0;
// Keeps the poles finite, far outside the square.
constexpr double kSineNearPole = 1 - 1e-15;

}  // namespace

GridPosition grid_from_metres(double x, double y) {
  return {x * kCellsPerMetre, -y * kCellsPerMetre};
}

GridPosition metres_from_grid(double x, double y) {
  return {x / kCellsPerMetre, -y / kCellsPerMetre};
}

double cells_from_ground(double metres, double y) {
  return metres * kCellsPerMetre * std::cosh(y / kCellsPerRadian);
}

LonLat lonlat_from_grid(double x, double y) {
  return {x / kCellsPerRadian / kDegree, std::atan(std::sinh(-y / kCellsPerRadian)) / kDegree};
}

GridPosition grid_from_lonlat(LonLat position) {
  // The inverse hyperbolic tangent of the sine is what is usually written asinh(tan(latitude)); it
  // takes a third of the time and is equal to within 1e-5 cells in the square.
  const double sine = std::clamp(std::sin(position.lat * kDegree), -kSineNearPole, kSineNearPole);
  return {position.lon * kDegree * kCellsPerRadian,
          -0.5 * std::log((1 + sine) / (1 - sine)) * kCellsPerRadian};
}

bool is_on_frame(Point a, Point b) {
  constexpr std::int32_t kStrip = 430'000;  // cells: from 85.0449 degrees on
  const auto is_pole = [](Point p) { return p.y <= kGridMin + kStrip || p.y >= kGridMax - kStrip; };
  const auto is_antimeridian = [](Point p) { return p.x == kGridMin || p.x == kGridMax; };
  return (a.x == b.x && is_antimeridian(a)) || (is_pole(a) && is_pole(b));
}

}  // namespace trapeze
