// Lists of tiles, for programs that purge or seed them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/grid/name_table.h"
#include "core/grid/web_mercator.h"

namespace trapeze {

enum class TileListFormat : std::uint8_t { geojson, json, text };

inline constexpr NameTable<TileListFormat, 3> kTileListNames({
    {"geojson", TileListFormat::geojson},
    {"json", TileListFormat::json},
    {"text", TileListFormat::text},
});

/// As text, a line z/x/y for each tile; as json, one line with an array of these; as geojson, a
/// feature for each with its square, in degrees, and its zoom, column and row. Ends with a line
/// feed, unless it is empty text. Any thread.
std::string tile_list(std::span<const TileId> tiles, TileListFormat format);

}  // namespace trapeze
