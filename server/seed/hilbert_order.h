// The order of tiles in an archive: by zoom, and within a zoom along a Hilbert curve, as PMTiles 3
// numbers them. All tiles of a zoom below a given tile have consecutive numbers.
//
// Thread-safety: any thread.
#pragma once

#include <array>
#include <cstdint>

#include "core/grid/web_mercator.h"

namespace trapeze {

/// The number of a tile within its zoom, from 0.
std::uint64_t place_on_curve(const TileId& tile);
/// The tile with that number.
TileId tile_at_place(int zoom, std::uint64_t place);

/// The number of the first tile of a zoom, counted over all zooms.
std::uint64_t first_id_of_zoom(int zoom);

/// The four tiles of the next zoom, in order.
std::array<TileId, 4> children_in_order(const TileId& tile);

/// Consecutive tiles of a zoom.
struct PlaceRange {
  std::uint64_t first = 0;
  std::uint64_t count = 1;
};
/// The tiles of a zoom below the tile; `zoom` is at least that of the tile.
PlaceRange places_below(const TileId& tile, int zoom);

}  // namespace trapeze
