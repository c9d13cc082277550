#include "server/seed/hilbert_order.h"

#include <utility>

namespace trapeze {
namespace {

/// Turns the square with that side so that its curve begins where the previous one ended.
void turn(std::uint32_t side, std::uint32_t right, std::uint32_t lower, std::uint32_t& x,
          std::uint32_t& y) {
  if (lower != 0) return;
  if (right != 0) {
    x = (side - 1) - (x & (side - 1));
    y = (side - 1) - (y & (side - 1));
  }
  std::swap(x, y);
}

}  // namespace

std::uint64_t place_on_curve(const TileId& tile) {
  std::uint64_t place = 0;
  std::uint32_t x = tile.x;
  std::uint32_t y = tile.y;
  for (int bit = tile.z - 1; bit >= 0; --bit) {
    const std::uint32_t right = x >> bit & 1;
    const std::uint32_t lower = y >> bit & 1;
    place = place << 2 | ((3 * right) ^ lower);
    turn(1u << bit, right, lower, x, y);
  }
  return place;
}

TileId tile_at_place(int zoom, std::uint64_t place) {
  TileId tile{zoom, 0, 0};
  for (int bit = 0; bit < zoom; ++bit) {
    const auto right = static_cast<std::uint32_t>(place >> 1 & 1);
    const auto lower = static_cast<std::uint32_t>((place & 1) ^ right);
    const std::uint32_t side = 1u << bit;
    turn(side, right, lower, tile.x, tile.y);
    tile.x += side * right;
    tile.y += side * lower;
    place >>= 2;
  }
  return tile;
}

std::uint64_t first_id_of_zoom(int zoom) {
  return ((std::uint64_t{1} << 2 * zoom) - 1) / 3;
}

std::array<TileId, 4> children_in_order(const TileId& tile) {
  std::array<TileId, 4> children;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const TileId child{tile.z + 1, 2 * tile.x + (i & 1), 2 * tile.y + (i >> 1)};
    children[place_on_curve(child) & 3] = child;
  }
  return children;
}

PlaceRange places_below(const TileId& tile, int zoom) {
  const int down = 2 * (zoom - tile.z);
  return {place_on_curve(tile) << down, std::uint64_t{1} << down};
}

}  // namespace trapeze
