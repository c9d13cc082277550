// Requests for URLs below /tiles/, as types. All input is untrusted until it is parsed.
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

/// As in file name extensions.
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

  /// The zoom of Web Mercator at which pixels have the same size.
  double zoom() const;
};

/// A description of tiles: /tiles/{layers}[/s/{style}][@{1-4}x].json
struct TileJsonRequest {
  std::vector<std::string> layers;
  StyleLink style;
  int scale = 1;
  StyleQuery full_style = {};  // the style that the link refers to
};

using TilesRequest = std::variant<TileRequest, TileJsonRequest>;

Problem malformed_target();

/// Parses a target whose path begins with /tiles, and fills in the settings of its style. The
/// problem is 400 for a malformed target, 404 for a tile outside the matrix or an unknown style in
/// the path.
Result<TilesRequest> parse_tiles_target(const Target& target, const StyleBook& styles,
                                        const TileMatrixSets& sets = TileMatrixSets::built_in());

/// Parses a comma-separated list of names; duplicates are dropped, bottom first.
Result<std::vector<std::string>> parse_layer_list(std::string_view list);

/// The pattern of tile URLs, for messages.
inline constexpr std::string_view kTilePattern =
    "/tiles/{layers}[/{tile matrix set}]/{z}/{x}/{y}[@{1-4}x].{png,webp}";

/// The file name of a picture, split into its parts. Views into the text that it was parsed from.
struct PictureName {
  std::string_view stem;  // "7" of "7@2x.png"
  int scale = 1;
  TileFormat format = TileFormat::png;
};
/// `pattern` describes such URLs in the problem, 400.
Result<PictureName> parse_picture_name(std::string_view name,
                                       std::string_view pattern = kTilePattern);

/// Removes /s/{style} after the second segment of a path, and adds the name of the style to the
/// query. Handles {...}/{layers}/s/{style}/{...} and {...}/{layers}/s/{style}.{...}; in the latter
/// the extension moves to the layers.
void take_style(std::vector<std::string>& path, std::vector<QueryPair>& query);

/// "@2x" for scale 2; empty for scale 1.
std::string scale_suffix(int scale);

/// Parses the z, x and y of a tile written as "Z/X/Y", z being the id of a matrix of the set.
Result<TileId> parse_tile_id(std::string_view z, std::string_view x, std::string_view y,
                             const TileMatrixSet& set = *web_mercator_quad());

/// The problem to answer with, 404, for an unknown tile matrix set; `names` lists the known ones.
Problem unknown_tile_matrix_set(std::string_view id, const std::string& names);
/// The same for a tile that the set does not have.
Problem no_such_tile(const TileMatrixSet& set);

}  // namespace trapeze
