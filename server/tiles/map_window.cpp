#include "server/tiles/map_window.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/grid/plate_carree.h"

namespace trapeze {
namespace {

/// The number of the copy of the world that a place is in; 0 is the world itself.
std::int64_t copy_at(double x) {
  return static_cast<std::int64_t>(std::floor((x - kGridMin) / static_cast<double>(kGridSize)));
}

View moved_by_worlds(View view, std::int64_t worlds) {
  view.origin_x += worlds * kGridSize;
  return view;
}

/// Moves the view by whole worlds so that its west side lies in the world, where the world repeats.
View brought_home(const View& view) {
  if (view.projection == Projection::plane) return view;
  return moved_by_worlds(view, -copy_at(static_cast<double>(view.origin_x)));
}

}  // namespace

std::optional<View> view_of_window(const WindowSides& sides, int width, int height,
                                   Projection projection) {
  constexpr double kMost = static_cast<double>(kMostWorlds) * kGridSize;
  for (const double side : {sides.west, sides.north, sides.east, sides.south}) {
    if (!(std::abs(side) <= kMost)) return std::nullopt;  // also rejects NaN
  }
  const auto cell = [](double place) { return static_cast<std::int64_t>(std::llround(place)); };
  const std::int64_t columns = cell(sides.east) - cell(sides.west);
  const std::int64_t rows = cell(sides.south) - cell(sides.north);
  if (columns < 1 || rows < 1) return std::nullopt;
  View view;
  view.origin_x = cell(sides.west);
  view.origin_y = cell(sides.north);
  view.cells_per_pixel = static_cast<double>(columns) / width;
  view.stretch = static_cast<double>(rows) / height / view.cells_per_pixel;
  view.width = width;
  view.height = height;
  view.projection = projection;
  return brought_home(view);
}

View view_around(GridPosition centre, double zoom, int width, int height, int scale) {
  View view;
  view.cells_per_pixel = static_cast<double>(kGridSize) / std::exp2(zoom) / (kTilePixels * scale);
  view.width = width;
  view.height = height;
  view.origin_x = std::llround(centre.x - view.cells_per_pixel * width / 2);
  view.origin_y = std::llround(centre.y - view.cells_per_pixel * height / 2);
  return brought_home(view);
}

double zoom_of(const View& view, double scale) {
  const double cells = view.shorter_side() * scale * kTilePixels;
  return snapped_zoom(std::log2(static_cast<double>(kGridSize) / cells));
}

double snapped_zoom(double zoom) {
  constexpr double kRoundingError = 1e-9;
  const double whole = std::round(zoom);
  return std::abs(zoom - whole) < kRoundingError ? whole : zoom;
}

std::optional<Point> place_at(const View& view, double column, double row) {
  const double x = static_cast<double>(view.origin_x) + column * view.cells_per_pixel;
  const double y = view.y_from_row(row);
  const bool is_off = view.projection == Projection::plane && (x < kGridMin || x >= kGridMax);
  if (is_off || y < kGridMin || y >= kGridMax) return std::nullopt;
  const double from_west = std::fmod(x - kGridMin, static_cast<double>(kGridSize));
  return Point{static_cast<std::int32_t>(std::floor(from_west) + kGridMin),
               static_cast<std::int32_t>(std::floor(y))};
}

std::optional<WindowSides> sides_in(Projection to, const WindowSides& sides, Projection from) {
  if (to == from) return sides;
  const auto converted = [to](double y) {
    if (to == Projection::plate_carree) return plate_carree_from_mercator(y);
    return std::clamp<double>(mercator_from_plate_carree(y), kGridMin, kGridMax);
  };
  const WindowSides made{sides.west, converted(sides.north), sides.east, converted(sides.south)};
  return made.height() > 0 ? std::optional(made) : std::nullopt;
}

std::vector<View> views_of_copies(const View& view, double around) {
  if (view.projection == Projection::plane) return {view};
  const double west = static_cast<double>(view.origin_x) - around * view.cells_per_pixel;
  const double east =
      static_cast<double>(view.origin_x) + (view.width + around) * view.cells_per_pixel;
  const auto last =
      static_cast<std::int64_t>(std::ceil((east - kGridMin) / static_cast<double>(kGridSize)) - 1);
  std::vector<View> views;
  for (std::int64_t copy = copy_at(west); copy <= last; ++copy) {
    views.push_back(moved_by_worlds(view, -copy));
  }
  return views;
}

}  // namespace trapeze
