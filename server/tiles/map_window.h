// Windows of the map: where a picture of any size and place lies on the grid.
//
// Thread-safety: any thread.
#pragma once

#include <optional>
#include <vector>

#include "core/grid/web_mercator.h"
#include "render/mask/mask.h"

namespace trapeze {

/// How many widths of the world a window may be away from the middle of the world, in either
/// direction.
constexpr int kMostWorlds = 8;

/// The sides of a window, in cells, not yet rounded. y grows southwards.
struct WindowSides {
  double west = 0;
  double north = 0;
  double east = 0;
  double south = 0;

  double width() const { return east - west; }
  double height() const { return south - north; }
};

/// The picture of a window, of width x height pixels. Each side is moved to the nearest whole cell,
/// by at most half a cell, which is less than a centimetre; nothing in the picture moves further.
/// West and east of the world, the world repeats: the picture shows the window moved by whole
/// worlds so that its west side lies in the world. Returns nothing if a side is more than
/// kMostWorlds away, or if the window is less than a cell wide or high. In plate carree, cells are
/// of equal degrees.
std::optional<View> view_of_window(const WindowSides& sides, int width, int height,
                                   Projection projection = Projection::mercator);

/// The picture around a place, of width x height pixels. Its pixels are as large as those of tiles
/// of that zoom, 0 to kMaxZoom, and scale. Its north-west corner is moved to the nearest whole
/// cell.
View view_around(GridPosition centre, double zoom, int width, int height, int scale);

/// The zoom at which tiles of that scale have pixels of the same size; if pixels are not square,
/// the shorter side counts. Exact for tiles.
double zoom_of(const View& view, double scale);

/// The zoom, without a rounding error if it is a whole one.
double snapped_zoom(double zoom);

/// The cell of the grid at a place of the picture, given in pixels; nothing if it is north or south
/// of the world.
std::optional<Point> place_at(const View& view, double column, double row);

/// The same window in another projection, without any parts that are off the map of Web Mercator.
/// Nothing if no part is left.
std::optional<WindowSides> sides_in(Projection to, const WindowSides& sides, Projection from);

/// The views of the copies of the world that the picture reaches, one for each copy: the world
/// repeats from west to east, and in each view that copy lies where the world is. Usually this is
/// just the view itself. With `around`, also copies up to so many pixels beyond the picture, whose
/// outlines may reach into it.
std::vector<View> views_of_copies(const View& view, double around = 0);

}  // namespace trapeze
