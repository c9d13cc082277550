#include "server/documents/ogc_map.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "core/io/source/target_grid.h"
#include "render/picture/webp.h"
#include "server/data/layer_summary.h"
#include "server/documents/map_picture.h"
#include "server/tiles/map_window.h"
#include "server/tiles/tile_matrix_set.h"

namespace trapeze {
namespace {

constexpr std::array<std::string_view, 9> kOgcMapParameters = {
    "bbox", "bbox-crs", "bgcolor", "collections", "crs", "f", "height", "transparent", "width"};

/// The system that a parameter names, or the default.
Result<MapSystemPtr> system_of(const DocumentRequest& request, std::string_view parameter,
                               const MapSystemPtr& usual) {
  const std::string* name = request.find(parameter);
  if (name == nullptr) return usual;
  if (auto system = find_map_system(*name, request.dataset)) return system;
  return bad_value(parameter, *name, uris_of(map_systems_of(request.dataset)));
}

/// Of all layers together.
Result<WindowSides> sides_of_layers(const std::vector<std::string>& layers, const MapSystem& system,
                                    const DocumentRequest& request) {
  const auto summary = summarize_layers(layers, request.dataset);
  if (!summary) return summary.problem();
  Box box = summary->box;
  if (!system.grid.empty()) {
    box = Box{};
    for (const std::string& layer : layers) {
      const ServedLayer* served = served_in(request.dataset, layer, system);
      if (served == nullptr) return not_built(layer, system, request.dataset);
      box.include(served->layer->bounds());
    }
  }
  const bool has_size = !box.is_empty() && box.min_x < box.max_x && box.min_y < box.max_y;
  const Box some = has_size ? box : Box{kGridMin, kGridMin, kGridMax, kGridMax};
  return system.sides_of(system.bounds_of(some));
}

/// The bounds on the plane of a box in degrees; nothing if a part of the box cannot be projected.
std::optional<WindowSides> sides_on_plane(const MapSystem& degrees, const WindowSides& box,
                                          const MapSystem& system) {
  constexpr int kSamples = 64;
  const GridPosition from = degrees.units_from(box.west, box.south);
  const GridPosition to = degrees.units_from(box.east, box.north);
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i <= kSamples; ++i) {
    for (int j = 0; j <= kSamples; ++j) {
      x.push_back(from.x + (to.x - from.x) * i / kSamples);
      y.push_back(from.y + (to.y - from.y) * j / kSamples);
    }
  }
  GridTransform transform(*find_target_grid(system.grid));
  if (!transform.to_cells(x, y)) return std::nullopt;
  const auto [west, east] = std::ranges::minmax(x);
  const auto [north, south] = std::ranges::minmax(y);
  return WindowSides{west, north, east, south};
}

Result<WindowSides> sides_of(const std::vector<std::string>& layers, const MapSystem& system,
                             const DocumentRequest& request) {
  const auto of_box = system_of(request, "bbox-crs", crs84());
  if (!of_box) return of_box.problem();
  const std::string* text = request.find("bbox");
  if (text == nullptr) return sides_of_layers(layers, system, request);
  const bool is_other_plane = (*of_box)->grid != system.grid;
  if (is_other_plane && !(*of_box)->is_in_degrees) {
    return Problem{
        400,
        fmt::format("A box of a map in {0} is in degrees, or in {0} as well: bbox-crs={1}.",
                    system.name, system.uri),
        "bbox-crs", (*of_box)->uri, system.uri};
  }
  auto sides = parse_window_around(**of_box, *text, AxisOrder::of_authority);
  if (sides && is_other_plane) {
    sides = sides_on_plane(**of_box, *sides, system);
  } else if (sides) {
    sides = sides_in(system.projection, *sides, (*of_box)->projection);
  }
  if (!sides) {
    return bad_value("bbox", *text,
                     "west, south, east and north, separated by commas, in degrees or as bbox-crs "
                     "says");
  }
  return *sides;
}

/// That many times as large around the same middle, and not less after rounding to cells.
WindowSides enlarged(const WindowSides& sides, double times) {
  const double x = sides.width() * (times - 1) / 2 + 1;
  const double y = sides.height() * (times - 1) / 2 + 1;
  return {sides.west - x, sides.north - y, sides.east + x, sides.south + y};
}

/// The view of the box or, without one, of the layers, and of so much around them that pixels are
/// not smaller than at the last zoom.
Result<View> view_of(const WindowSides& sides, const MapSystem& system,
                     const DocumentRequest& request) {
  auto view = map_view(sides, request, 1, system.projection);
  if (!view || request.find("bbox") != nullptr) return view;
  const double beyond = system.zoom_of(*view, 1) - request.max_zoom;
  if (!(beyond > 0)) return view;
  return map_view(enlarged(sides, std::exp2(beyond)), request, 1, system.projection);
}

/// The format given by `f`.
Result<TileFormat> format_of(const DocumentRequest& request) {
  const std::string* name = request.find("f");
  if (name == nullptr || *name == "png") return TileFormat::png;
  if (*name == "webp" && has_webp()) return TileFormat::webp;
  return bad_value("f", *name, has_webp() ? "png or webp" : "png");
}

/// According to the standard, a map is transparent unless it has a background colour.
Result<std::vector<QueryPair>> background_of(const DocumentRequest& request) {
  const std::string* colour = request.find("bgcolor");
  const std::string* transparent = request.find("transparent");
  if (transparent != nullptr && *transparent != "true" && *transparent != "false") {
    return bad_value("transparent", *transparent, "true or false");
  }
  const bool is_transparent = transparent != nullptr ? *transparent == "true" : colour == nullptr;
  const std::string text = colour != nullptr ? *colour : "FFFFFF";
  const auto parsed = parse_colour(text.starts_with("0x") ? text.substr(2) : text);
  if (!parsed) return bad_value("bgcolor", text, "a colour such as 0xFFFFFF, or its name");
  if (is_transparent) return std::vector<QueryPair>();
  return std::vector<QueryPair>{{"background", to_hex(*parsed)}};
}

}  // namespace

Result<WindowRequest> parse_ogc_map(const std::vector<std::string>& layers,
                                    const DocumentRequest& request) {
  const auto system = system_of(request, "crs", web_mercator());
  if (!system) return system.problem();
  const auto format = format_of(request);
  if (!format) return format.problem();
  const auto sides = sides_of(layers, **system, request);
  if (!sides) return sides.problem();
  const auto view = view_of(*sides, **system, request);
  if (!view) return view.problem();
  const auto background = background_of(request);
  if (!background) return background.problem();
  DocumentRequest styled = request;
  if (request.find("background") == nullptr) {
    styled.query.insert(styled.query.end(), background->begin(), background->end());
  }
  auto style = styled.style_for(layers, kOgcMapParameters);
  if (!style) return std::move(style).problem();
  return WindowRequest{layers, *view, 1, *std::move(style), *format, "map", *system};
}

}  // namespace trapeze
