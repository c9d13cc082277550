#include "core/web_mercator.h"

#include <cmath>
#include <numbers>

namespace trapeze {
namespace {

constexpr double kCellsPerMetre = static_cast<double>(kGridMax) / kMercatorHalfSide;
constexpr double kCellsPerRadian = static_cast<double>(kGridMax) / std::numbers::pi;
constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

GridPosition grid_from_metres(double x, double y) {
  return {x * kCellsPerMetre, -y * kCellsPerMetre};
}

GridPosition metres_from_grid(double x, double y) {
  return {x / kCellsPerMetre, -y / kCellsPerMetre};
}

LonLat lonlat_from_grid(double x, double y) {
  return {x / kCellsPerRadian / kDegree, std::atan(std::sinh(-y / kCellsPerRadian)) / kDegree};
}

GridPosition grid_from_lonlat(LonLat position) {
  return {position.lon * kDegree * kCellsPerRadian,
          -std::asinh(std::tan(position.lat * kDegree)) * kCellsPerRadian};
}

}  // namespace trapeze
