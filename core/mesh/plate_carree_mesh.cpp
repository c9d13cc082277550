#include "core/mesh/plate_carree_mesh.h"

#include <algorithm>
#include <cmath>

namespace trapeze {
namespace {

/// The greatest multiple of `height`, a power of two, that is not above y.
std::int64_t cut_before(std::int64_t y, std::int64_t height) {
  return y & ~(height - 1);
}

}  // namespace

void PlateCarreeMesh::begin(double cells_per_row, const Box& box) {
  height_ = straight_height(kMostCurved * cells_per_row);
  north_ = box.min_y;
  south_ = box.max_y;
  vertices_.clear();
  edges_.clear();
  trapezoids_.clear();
}

void PlateCarreeMesh::add(const MeshView& mesh, std::span<const TrapezoidRange> ranges) {
  std::size_t count = trapezoids_.size();  // a lower bound, usually not much exceeded
  for (const TrapezoidRange& range : ranges) count += range.count;
  trapezoids_.reserve(count);
  edges_.reserve(2 * count);
  vertices_.reserve(6 * count);
  for_each_trapezoid(ranges, [&](std::uint32_t i) { add(mesh, mesh.trapezoids[i]); });
}

void PlateCarreeMesh::add(const MeshView& mesh, const MeshTrapezoid& trapezoid) {
  const std::int64_t top = std::max<std::int64_t>(mesh.vertices[trapezoid.top].y, north_);
  const std::int64_t bottom = std::min<std::int64_t>(mesh.vertices[trapezoid.bottom].y, south_);
  if (top >= bottom) return;
  const auto side_of = [&mesh](std::uint32_t edge) {
    return Side{mesh.vertices[mesh.edges[edge].upper], mesh.vertices[mesh.edges[edge].lower]};
  };
  const Side left = side_of(trapezoid.left);
  const Side right = side_of(trapezoid.right);
  if (!is_cut(left) && !is_cut(right)) return append(top, bottom, left, right);
  for (std::int64_t y = top; y < bottom;) {
    const std::int64_t end = std::min(cut_before(y, height_) + height_, bottom);
    append(y, end, piece_at(left, y), piece_at(right, y));
    y = end;
  }
}

void PlateCarreeMesh::append(std::int64_t top, std::int64_t bottom, const Side& left,
                             const Side& right) {
  const std::int32_t from = plate_carree_row(static_cast<std::int32_t>(top));
  const std::int32_t to = plate_carree_row(static_cast<std::int32_t>(bottom));
  if (from >= to) return;
  const auto v = static_cast<std::uint32_t>(vertices_.size());
  const auto e = static_cast<std::uint32_t>(edges_.size());
  vertices_.insert(vertices_.end(),
                   {projected(left.upper), projected(left.lower), projected(right.upper),
                    projected(right.lower), Point{left.upper.x, from}, Point{left.upper.x, to}});
  edges_.insert(edges_.end(), {{v, v + 1}, {v + 2, v + 3}});
  trapezoids_.push_back({v + 4, v + 5, e, e + 1});
}

// Vertical sides stay straight.
bool PlateCarreeMesh::is_cut(const Side& side) const {
  return side.upper.x != side.lower.x && std::int64_t{side.lower.y} - side.upper.y > height_;
}

/// The piece between the cuts before and after that height.
PlateCarreeMesh::Side PlateCarreeMesh::piece_at(const Side& side, std::int64_t y) const {
  if (!is_cut(side)) return side;
  const std::int64_t from = cut_before(y, height_);
  const std::int64_t to = from + height_;
  return {from <= side.upper.y ? side.upper : on_side(side, from),
          to >= side.lower.y ? side.lower : on_side(side, to)};
}

Point PlateCarreeMesh::on_side(const Side& side, std::int64_t y) const {
  const double x = EdgeLine(side.upper, side.lower).x_at(static_cast<double>(y));
  return {static_cast<std::int32_t>(std::lround(x)), static_cast<std::int32_t>(y)};
}

void PlateCarreeMesh::cut(Point from, Point to, std::vector<PointOnWay>& points) {
  points.clear();
  const bool goes_up = to.y < from.y;
  const Side side = goes_up ? Side{to, from} : Side{from, to};
  const auto add = [&](Point place, double share) {
    const Point drawn = projected(place);
    if (points.empty() || points.back().place != drawn) {
      points.push_back({drawn, share});
    } else if (points.size() > 1) {
      points.back().share = share;  // exact at the end
    }
  };
  if (!is_cut(side)) {
    add(from, 0);
    add(to, 1);
  } else {
    const double all = static_cast<double>(side.lower.y) - side.upper.y;
    // One piece beyond the box on either side: anything farther away is not visible.
    const std::int64_t first = std::max<std::int64_t>(side.upper.y, cut_before(north_, height_));
    const std::int64_t last =
        std::min<std::int64_t>(side.lower.y, cut_before(south_, height_) + height_);
    for (std::int64_t y = first; y <= last;) {
      const bool is_end = y == side.upper.y || y == side.lower.y;
      const Point place = !is_end ? on_side(side, y) : y == side.upper.y ? side.upper : side.lower;
      add(place, (static_cast<double>(y) - side.upper.y) / all);
      if (y == last) break;
      y = std::min(cut_before(y, height_) + height_, last);
    }
    if (goes_up) {
      std::ranges::reverse(points);
      for (PointOnWay& point : points) point.share = 1 - point.share;
    }
  }
  if (points.size() < 2) points.clear();
}

}  // namespace trapeze
