// The order of tiles in an archive: zoom by zoom, and within a zoom along a Hilbert curve, as
// PMTiles 3 numbers them. All tiles of a zoom below a tile have successive numbers.
//
// Any thread.
#pragma once

#include <array>
#include <cstdint>

#include "core/grid/web_mercator.h"

namespace trapeze {

/// The number of a tile among those of its zoom, from 0 on.
std::uint64_t place_on_curve(const TileId& tile);
/// The tile with that number.
TileId tile_at_place(int zoom, std::uint64_t place);

/// The number of the first tile of a zoom among those of all zooms.
std::uint64_t first_id_of_zoom(int zoom);

/// The four tiles of the next zoom, in order.
std::array<TileId, 4> children_in_order(const TileId& tile);

/// Tiles that follow each other within a zoom.
struct PlaceRange {
  std::uint64_t first = 0;
  std::uint64_t count = 1;
};
/// Those of a zoom that lie below the tile; `zoom` is not less than its own.
PlaceRange places_below(const TileId& tile, int zoom);

}  // namespace trapeze
