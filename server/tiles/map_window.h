// Windows of the map: where a picture of any size and place lies on the grid.
//
// Thread-safety: any thread.
#pragma once

#include <optional>
#include <vector>

#include "core/grid/web_mercator.h"
#include "render/mask/mask.h"

namespace trapeze {

/// How many widths of the world a window may be away from its middle, in either direction.
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

/// The picture of a window, of width x height pixels. Its sides are moved to the nearest whole
/// cells, each by half a cell at most, which is less than a centimetre; so nothing in the picture
/// moves further either. West of the world or east of it, the world repeats: the picture is that of
/// the window around the world whose west is on it. Nothing if a side is more than kMostWorlds
/// away, or if the window is less than a cell wide or high.
/// In plate carree, cells are of equal degrees.
std::optional<View> view_of_window(const WindowSides& sides, int width, int height,
                                   Projection projection = Projection::mercator);

/// The picture around a place, of width x height pixels as large as those of tiles of that zoom, 0
/// to kMaxZoom, and scale. Its north-west corner is moved to the nearest whole cell.
View view_around(GridPosition centre, double zoom, int width, int height, int scale);

/// The zoom at which tiles of that scale have pixels as large; of pixels that are not square, the
/// shorter side counts. Exact for tiles.
double zoom_of(const View& view, double scale);

/// The cell of the grid at a place of the picture, counted in pixels; nothing if that is off the
/// world in the north or south.
std::optional<Point> place_at(const View& view, double column, double row);

/// The same window in another projection; parts of it that are not on the map of Web Mercator are
/// left out. Nothing if nothing is left.
std::optional<WindowSides> sides_in(Projection to, const WindowSides& sides, Projection from);

/// The world repeats from west to east: the views, one for each of its copies that the picture
/// reaches, in which that copy lies where the world is. Mostly there is one, the view itself. With
/// `around`, also those that are so many pixels away: their outlines may reach into the picture.
std::vector<View> views_of_copies(const View& view, double around = 0);

}  // namespace trapeze
