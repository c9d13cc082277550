// What a URL below /tiles/ asks for, as types. Everything here is untrusted until parsed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/name_table.h"
#include "core/grid/web_mercator.h"
#include "server/base/limits.h"
#include "server/base/result.h"
#include "server/base/url.h"
#include "server/styles/style_book.h"
#include "server/styles/style_parameters.h"
#include "server/tiles/tile_matrix_set.h"

namespace trapeze {

enum class TileFormat : std::uint8_t { png, webp };

/// As files end.
inline constexpr NameTable<TileFormat, 2> kTileFormatNames({
    {"png", TileFormat::png},
    {"webp", TileFormat::webp},
});

/// "image/png" or "image/webp".
std::string_view content_type_of(TileFormat format);

/// One tile: /tiles/{layers}[/s/{style}][/{tile matrix set}]/{z}/{x}/{y}[@{1-4}x].{png,webp}
struct TileRequest {
  std::vector<std::string> layers;  // valid names, each once, bottom first
  TileId tile;                      // one of the set
  int scale = 1;
  StyleQuery style;
  TileFormat format = TileFormat::png;
  TileMatrixSetPtr set = web_mercator_quad();

  /// The zoom of Web Mercator at which pixels are as large.
  double zoom() const;
};

/// A description of tiles: /tiles/{layers}[/s/{style}][@{1-4}x].json
struct TileJsonRequest {
  std::vector<std::string> layers;
  StyleLink style;
  int scale = 1;
  StyleQuery full_style = {};  // what the link leads to
};

using TilesRequest = std::variant<TileRequest, TileJsonRequest>;

Problem malformed_target();

/// Parses a target whose path begins with /tiles, and puts in place what its style says. The
/// problem is 400 for what is malformed, 404 for a tile outside of the matrix or a style in the
/// path that there is not.
Result<TilesRequest> parse_tiles_target(const Target& target, const StyleBook& styles,
                                        const TileMatrixSets& sets = TileMatrixSets::built_in());

/// Parses names separated by commas; each is taken once, bottom first.
Result<std::vector<std::string>> parse_layer_list(std::string_view list);

/// What addresses of tiles look like, for messages.
inline constexpr std::string_view kTilePattern =
    "/tiles/{layers}[/{tile matrix set}]/{z}/{x}/{y}[@{1-4}x].{png,webp}";

/// The name of a picture, in parts: views into the text that it was parsed from.
struct PictureName {
  std::string_view stem;  // "7" of "7@2x.png"
  int scale = 1;
  TileFormat format = TileFormat::png;
};
/// `pattern` is what such addresses look like, for the problem, 400.
Result<PictureName> parse_picture_name(std::string_view name,
                                       std::string_view pattern = kTilePattern);

/// From a path with /s/{style} after its second segment to the same without it, and the name of the
/// style to the query: from {...}/{layers}/s/{style}/{...}, and from
/// {...}/{layers}/s/{style}.{...}, the ending of which the layers get.
void take_style(std::vector<std::string>& path, std::vector<QueryPair>& query);

/// "@2x" of the scale 2; nothing of the scale 1.
std::string scale_suffix(int scale);

/// Parses the z, x, y of a tile written as "Z/X/Y", z being the id of a matrix of the set.
Result<TileId> parse_tile_id(std::string_view z, std::string_view x, std::string_view y,
                             const TileMatrixSet& set = *web_mercator_quad());

/// The problem to answer with, 404, for the id of a tile matrix set that there is not, and not
/// among these, which there are.
Problem unknown_tile_matrix_set(std::string_view id, const std::string& names);
/// The same for a tile that the set does not have.
Problem no_such_tile(const TileMatrixSet& set);

}  // namespace trapeze
