#include "core/io/source/grid_rings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/grid/grid.h"

namespace trapeze {
namespace {

constexpr ClipWindow kGrid = {static_cast<double>(kGridMin), static_cast<double>(kGridMin),
                              static_cast<double>(kGridMax), static_cast<double>(kGridMax)};
constexpr double kSeamStep = 1.0 / 256;  // degrees: between cuts at these intervals a meridian
                                         // counts as straight
constexpr double kOnSeam = 1e-9;         // degrees

bool is_on_seam(Position p) {
  return std::abs(std::abs(p.x) - 180) <= kOnSeam;
}

/// Cuts edges along the antimeridian at fixed latitudes, the same for all rings.
PositionRing cut_along_seam(const PositionRing& ring) {
  PositionRing cut;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Position from = ring[i];
    const Position to = ring[i + 1 == ring.size() ? 0 : i + 1];
    cut.push_back(from);
    if (!is_on_seam(from) || !is_on_seam(to) || from.x != to.x) continue;
    const auto [south, north] = std::minmax(from.y, to.y);
    const auto first = static_cast<int>(std::floor(south / kSeamStep)) + 1;
    const auto last = static_cast<int>(std::ceil(north / kSeamStep)) - 1;
    const bool goes_north = to.y > from.y;
    for (int k = first; k <= last; ++k) {
      cut.push_back({from.x, (goes_north ? k : last - (k - first)) * kSeamStep});
    }
  }
  return cut;
}

}  // namespace

GridRings::GridRings(std::shared_ptr<const TargetGrid> grid)
    : grid_(std::move(grid)),
      transform_(*grid_),
      most_off_(std::max(0.25, kMostOffMetres / grid_->metres_per_cell())) {}

bool GridRings::project(const PositionRing& ring, std::vector<PositionRing>& made) {
  made.clear();
  if (ring.empty()) return true;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const PositionRing cut = cut_along_seam(ring);
  const auto by_longitude = [](Position a, Position b) { return a.x < b.x; };
  const auto [west, east] = std::minmax_element(cut.begin(), cut.end(), by_longitude);
  const double least = west->x;
  const double most = east->x;
  for (const double shift : {0.0, -360.0, 360.0}) {
    // If the grid goes around the world, anything beyond 180 degrees is already in place without a
    // shift.
    const bool is_seen = grid_->goes_around()
                             ? shift == 0
                             : least + shift < grid_->east && most + shift > grid_->west;
    if (!is_seen) continue;
    PositionRing part = cut;
    for (Position& p : part) p.x += shift;
    const bool is_whole = grid_->goes_around();
    clip_ring(part,
              {is_whole ? -kInfinity : grid_->west, grid_->south,
               is_whole ? kInfinity : grid_->east, grid_->north},
              scratch_);
    if (!part.empty() && !project_part(std::move(part), made)) return false;
  }
  return true;
}

bool GridRings::project_part(PositionRing part, std::vector<PositionRing>& made) {
  MappedRing ring{std::move(part), {}};
  const PointMap map = [this](std::vector<double>& x, std::vector<double>& y) {
    return transform_.to_cells(x, y);
  };
  if (!cut_edges(ring, map, distance_on_plane, most_off_)) return false;
  clip_ring(ring.after, kGrid, scratch_);
  if (!ring.after.empty()) made.push_back(std::move(ring.after));
  return true;
}

}  // namespace trapeze
