#include "server/tiles/tile_request.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <span>

#include "render/picture/webp.h"

namespace trapeze {
namespace {

constexpr std::string_view kTileJsonPattern = "/tiles/{layers}[@{1-4}x].json";
constexpr std::string_view kPng = ".png";
constexpr std::string_view kWebp = ".webp";
constexpr std::string_view kJson = ".json";

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// A decimal integer without leading zeros. A minus sign is allowed, so that tiles which maps
/// request beyond the edge of the world are "outside" and not "malformed".
bool is_integer(std::string_view text) {
  if (text.starts_with('-')) text.remove_prefix(1);
  if (text.empty() || (text.size() > 1 && text.front() == '0')) return false;
  return std::ranges::all_of(text, is_digit);
}

/// Nothing if the integer does not fit; such a number is outside every matrix, too.
std::optional<std::uint32_t> to_tile_number(std::string_view integer) {
  std::uint32_t number = 0;
  const auto [end, error] =
      std::from_chars(integer.data(), integer.data() + integer.size(), number);
  if (error != std::errc() || end != integer.data() + integer.size()) return std::nullopt;
  return number;
}

Result<TilesRequest> parse_tile(const std::vector<std::string>& path, const StyledQuery& query,
                                const TileMatrixSets& sets) {
  auto layers = parse_layer_list(path[1]);
  if (!layers) return std::move(layers).problem();
  const auto names = std::span(path).last(3);  // matrix, column and row
  auto file = parse_picture_name(names[2]);
  if (!file) return std::move(file).problem();
  const auto set = path.size() == 6 ? sets.find(path[2]) : web_mercator_quad();
  if (set == nullptr) {
    return unknown_tile_matrix_set(path[2], "those that /ogc/tileMatrixSets lists");
  }
  auto tile = parse_tile_id(names[0], names[1], file->stem, *set);
  if (!tile) return std::move(tile).problem();
  TileRequest request{*std::move(layers), *tile, file->scale, {}, file->format, set};
  auto style = query.style_for(request.layers);
  if (!style) return std::move(style).problem();
  request.style = *std::move(style);
  return TilesRequest(std::move(request));
}

/// A name without its extension, split: "7" and 2 for "7@2x".
struct ScaledStem {
  std::string_view stem;
  int scale = 1;
};
Result<ScaledStem> parse_scale(std::string_view name) {
  const std::size_t at = name.find('@');
  if (at == std::string_view::npos) return ScaledStem{name, 1};
  const std::string_view suffix = name.substr(at + 1);
  const bool is_scale =
      suffix.size() == 2 && suffix[0] >= '1' && suffix[0] <= '0' + kMaxScale && suffix[1] == 'x';
  if (!is_scale) {
    return Problem{400, fmt::format("A tile's scale is @1x to @{}x.", kMaxScale), "scale",
                   std::string(suffix), fmt::format("1x to {}x", kMaxScale)};
  }
  return ScaledStem{name.substr(0, at), suffix[0] - '0'};
}

Result<TilesRequest> parse_tile_json(std::string_view file, const StyledQuery& query) {
  file.remove_suffix(kJson.size());
  auto stem = parse_scale(file);
  if (!stem) return std::move(stem).problem();
  auto layers = parse_layer_list(stem->stem);
  if (!layers) return std::move(layers).problem();
  auto style = query.link_for(*layers);
  if (!style) return std::move(style).problem();
  auto full = query.style_for(*layers);
  if (!full) return std::move(full).problem();
  return TilesRequest(
      TileJsonRequest{*std::move(layers), *std::move(style), stem->scale, *std::move(full)});
}

/// TileJSON cannot state which tile matrix set it describes.
Problem no_tile_json(const std::string& set) {
  return {400, fmt::format(
                   "TileJSON is about tiles of Web Mercator, at /tiles/{{layers}}.json. The tiles "
                   "of {0} are at /tiles/{{layers}}/{0}/{{z}}/{{x}}/{{y}}.png; /wmts.xml and "
                   "/ogc/collections/{{layer}}/map/tiles/{0} describe them.",
                   set)};
}

bool has_style(std::span<const std::string> path) {
  if (path.size() < 3 || path[2] != "s") return false;
  return path.size() == 7 || path.size() == 8 || (path.size() == 4 && path[3].ends_with(kJson));
}

}  // namespace

std::string_view content_type_of(TileFormat format) {
  return format == TileFormat::webp ? "image/webp" : "image/png";
}

Result<std::vector<std::string>> parse_layer_list(std::string_view list) {
  std::vector<std::string> layers;
  while (true) {
    const std::size_t comma = std::min(list.find(','), list.size());
    const std::string_view name = list.substr(0, comma);
    if (!is_url_name(name)) {
      return Problem{400,
                     "The path names layers by 1 to 64 letters, digits, '_' or '-' each, "
                     "separated by commas.",
                     "layers", std::string(name), "layer names"};
    }
    if (std::ranges::find(layers, name) == layers.end()) layers.emplace_back(name);
    if (layers.size() > kMaxLayersPerTile) {
      return Problem{400, fmt::format("A tile shows at most {} layers.", kMaxLayersPerTile)};
    }
    if (comma == list.size()) return layers;
    list.remove_prefix(comma + 1);
  }
}

Result<PictureName> parse_picture_name(std::string_view name, std::string_view pattern) {
  const bool is_webp = name.ends_with(kWebp);
  if (!is_webp && !name.ends_with(kPng)) {
    return Problem{400, fmt::format("Images are PNG or WebP: {}.", pattern)};
  }
  if (is_webp && !has_webp()) {
    return Problem{400, "This server was built without WebP: use .png.", "format", "webp", "png"};
  }
  const TileFormat format = is_webp ? TileFormat::webp : TileFormat::png;
  name.remove_suffix(is_webp ? kWebp.size() : kPng.size());
  auto stem = parse_scale(name);
  if (!stem) return std::move(stem).problem();
  return PictureName{stem->stem, stem->scale, format};
}

void take_style(std::vector<std::string>& path, std::vector<QueryPair>& query) {
  std::string& style = path[3];
  if (path.size() == 4) {
    const std::size_t end = std::min({style.find('@'), style.rfind('.'), style.size()});
    path[1] += style.substr(end);
    style.resize(end);
  }
  query.emplace_back("style", std::move(style));
  path.erase(path.begin() + 2, path.begin() + 4);
}

std::string scale_suffix(int scale) {
  return scale == 1 ? std::string() : fmt::format("@{}x", scale);
}

double TileRequest::zoom() const {
  return set->matrices[static_cast<std::size_t>(tile.z)].zoom();
}

Problem unknown_tile_matrix_set(std::string_view id, const std::string& names) {
  return {404, fmt::format("There is no such tile matrix set; available: {}.", names),
          "tileMatrixSet", std::string(id), names};
}

Problem no_such_tile(const TileMatrixSet& set) {
  if (set.id == web_mercator_quad()->id) {
    return {404, fmt::format("There is no such tile: zoom is 0 to {}, column and row are 0 to "
                             "2^zoom - 1.",
                             kMaxZoom)};
  }
  return {404, fmt::format("There is no such tile in {}, which has the matrices {} to {}.", set.id,
                           set.matrices.front().id, set.matrices.back().id)};
}

Result<TileId> parse_tile_id(std::string_view z, std::string_view x, std::string_view y,
                             const TileMatrixSet& set) {
  const bool is_usual = set.id == web_mercator_quad()->id;
  for (const std::string_view number : {is_usual ? z : x, x, y}) {
    if (is_integer(number)) continue;
    return Problem{400,
                   fmt::format("Zoom, column and row of a tile are integers: {}.", kTilePattern),
                   "z/x/y", std::string(number), "an integer"};
  }
  const TileMatrix* matrix = set.find(z);
  const auto column = to_tile_number(x);
  const auto row = to_tile_number(y);
  if (matrix != nullptr && column && row) {
    const TileId tile{static_cast<int>(matrix - set.matrices.data()), *column, *row};
    if (set.has(tile)) return tile;
  }
  return no_such_tile(set);
}

Problem malformed_target() {
  return {400,
          "The target is not well formed: '%' comes with two hex digits, and control characters "
          "are not allowed."};
}

Result<TilesRequest> parse_tiles_target(const Target& target, const StyleBook& styles,
                                        const TileMatrixSets& sets) {
  auto path = decode_path(target.path);
  auto query = decode_query(target.query);
  if (!path || !query) {
    return malformed_target();
  }
  const bool is_styled = has_style(*path);
  if (is_styled) take_style(*path, *query);
  auto styled = styles.read(std::move(*query), is_styled ? 404 : 400);
  if (!styled) return std::move(styled).problem();
  if (path->size() == 5 || path->size() == 6) return parse_tile(*path, *styled, sets);
  if (path->size() == 2 && path->back().ends_with(kJson)) {
    return parse_tile_json(path->back(), *styled);
  }
  if (path->size() == 3 && path->back().ends_with(kJson)) {
    std::string set = path->back();
    set.resize(set.size() - kJson.size());
    if (sets.find(set) != nullptr) return no_tile_json(set);
  }
  return Problem{404,
                 fmt::format("There is nothing here. Tiles are at {}, their description at {}.",
                             kTilePattern, kTileJsonPattern)};
}

}  // namespace trapeze
