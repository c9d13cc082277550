#include "server/documents/map_picture.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/grid/web_mercator.h"
#include "server/documents/place_text.h"

namespace trapeze {
namespace {

constexpr std::array<std::string_view, 4> kPictureParameters = {"bbox", "crs", "height", "width"};
constexpr std::string_view kPicturePattern =
    "/map/{layers}.png?bbox=W,S,E,N or /map/{layers}/{lon},{lat},{zoom}/{width}x{height}.png";
constexpr int kUsualSide = 1024;  // the longer side, in pixels at scale 1

std::optional<WindowSides> sides_between(GridPosition south_west, GridPosition north_east) {
  const WindowSides sides{south_west.x, north_east.y, north_east.x, south_west.y};
  if (!(sides.width() > 0 && sides.height() > 0)) return std::nullopt;
  return sides;
}

std::optional<WindowSides> sides_between(const MapSystem& system, const SystemBounds& bounds) {
  return sides_between(system.cells_from(bounds.west, bounds.south),
                       system.cells_from(bounds.east, bounds.north));
}

std::optional<SystemBounds> parse_bounds(const MapSystem& system, std::string_view text,
                                         AxisOrder order) {
  const double middle = std::max(std::abs(system.middle_x), std::abs(system.middle_y));
  const auto numbers = parse_four_numbers(text, middle + 2 * system.half_side * kMostWorlds);
  if (!numbers) return std::nullopt;
  const auto [a, b, c, d] = *numbers;
  const bool is_north_first = order == AxisOrder::of_authority && system.is_north_first;
  return is_north_first ? SystemBounds{b, a, d, c} : SystemBounds{a, b, c, d};
}

/// "{lon},{lat},{zoom}".
struct Centre {
  GridPosition place;
  double zoom = 0;
};

std::optional<Centre> parse_centre(std::string_view text) {
  const std::size_t first = std::min(text.find(','), text.size());
  const std::size_t second = text.find(',', std::min(first + 1, text.size()));
  if (second == std::string_view::npos) return std::nullopt;
  const auto lon = parse_number(text.substr(0, first), -360, 360);
  const auto lat =
      parse_number(text.substr(first + 1, second - first - 1), -kMaxLatitude, kMaxLatitude);
  const auto zoom = parse_number(text.substr(second + 1), 0, kMaxZoom);
  if (!lon || !lat || !zoom) return std::nullopt;
  return Centre{grid_from_lonlat({*lon, *lat}), *zoom};
}

/// In pixels at scale 1.
struct PictureSize {
  int width = 0;
  int height = 0;
};

/// "{width}x{height}".
std::optional<PictureSize> parse_size(std::string_view text) {
  const std::size_t x = std::min(text.find('x'), text.size());
  const auto width = parse_pixels(text.substr(0, x));
  const auto height = parse_pixels(text.substr(std::min(x + 1, text.size())));
  if (!width || !height) return std::nullopt;
  return PictureSize{*width, *height};
}

Problem bad_window(const std::string& value) {
  return bad_value("bbox", value,
                   fmt::format("west, south, east and north, separated by commas, south less than "
                               "north, in degrees, of which the map has those up to latitude "
                               "{:.4f}, or as crs says, not narrower than a centimetre and at most "
                               "{} worlds away",
                               kMaxLatitude, kMostWorlds));
}

Problem too_large(int width, int height) {
  return {400, fmt::format("An image is at most {} pixels wide and high.", kMaxPicturePixels),
          width > height ? "width" : "height", fmt::format("{} x {}", width, height),
          fmt::format("1 to {}", kMaxPicturePixels)};
}

Result<MapSystemPtr> system_of(const DocumentRequest& request) {
  const std::string* crs = request.find("crs");
  if (crs == nullptr) return web_mercator();
  if (auto system = find_map_system(*crs, request.dataset)) return system;
  return bad_value("crs", *crs,
                   fmt::format("{}; without it, maps are in EPSG:3857 and bbox is in degrees",
                               names_of(map_systems_of(request.dataset))));
}

/// Eastings are always first, with or without a reference system in the request.
Result<WindowSides> sides_of(const MapSystem& system, const DocumentRequest& request) {
  const std::string* text = request.find("bbox");
  const std::string value = text == nullptr ? std::string() : *text;
  const auto sides = request.find("crs") != nullptr
                         ? parse_window_around(system, value, AxisOrder::east_first)
                         : parse_window_in_degrees(value);
  if (!sides) return bad_window(value);
  return *sides;
}

Result<std::optional<int>> pixels_of(const DocumentRequest& request, std::string_view name) {
  const std::string* text = request.find(name);
  if (text == nullptr) return std::optional<int>();
  if (const auto pixels = parse_pixels(*text)) return pixels;
  return bad_value(name, *text, fmt::format("an integer from 1 to {}", kMaxPicturePixels));
}

int side_for(double ratio, int other) {
  return static_cast<int>(
      std::clamp<double>(std::round(ratio * other), 1, double{kMaxPicturePixels}));
}

Result<PictureSize> size_of(const WindowSides& sides, const DocumentRequest& request) {
  const auto width = pixels_of(request, "width");
  if (!width) return width.problem();
  const auto height = pixels_of(request, "height");
  if (!height) return height.problem();
  const double ratio = sides.width() / sides.height();
  if (*width && *height) return PictureSize{**width, **height};
  if (*width) return PictureSize{**width, side_for(1 / ratio, **width)};
  if (*height) return PictureSize{side_for(ratio, **height), **height};
  if (ratio >= 1) return PictureSize{kUsualSide, side_for(1 / ratio, kUsualSide)};
  return PictureSize{side_for(ratio, kUsualSide), kUsualSide};
}

/// Parses everything in a request except its style.
Result<WindowRequest> parse_with_box(const DocumentRequest& request) {
  const auto name = parse_picture_name(request.path[1], kPicturePattern);
  if (!name) return name.problem();
  auto layers = parse_layer_list(name->stem);
  if (!layers) return std::move(layers).problem();
  const auto system = system_of(request);
  if (!system) return system.problem();
  const auto sides = sides_of(**system, request);
  if (!sides) return sides.problem();
  const auto view = map_view(*sides, request, name->scale, (*system)->projection);
  if (!view) return view.problem();
  return WindowRequest{
      *std::move(layers), *view,  static_cast<double>(name->scale), {}, name->format,
      request.path[1],    *system};
}

Problem not_around_a_place(std::string_view parameter, const std::string& value) {
  return {400,
          fmt::format("The parameter {} goes with a box, {}: a picture around a place is in Web "
                      "Mercator, and its address has its size.",
                      parameter, kPicturePattern.substr(0, kPicturePattern.find(' '))),
          std::string(parameter), value, "/map/{layers}.png?bbox=W,S,E,N"};
}

Result<WindowRequest> parse_with_centre(const DocumentRequest& request) {
  auto layers = parse_layer_list(request.path[1]);
  if (!layers) return std::move(layers).problem();
  for (const std::string_view name : kPictureParameters) {
    if (const std::string* value = request.find(name)) return not_around_a_place(name, *value);
  }
  const auto centre = parse_centre(request.path[2]);
  const auto name = parse_picture_name(request.path[3], kPicturePattern);
  if (!name) return name.problem();
  const auto size = parse_size(name->stem);
  if (!centre || !size) {
    const std::string takes =
        centre ? fmt::format("width and height, each from 1 to {} pixels, such as 512x384",
                             kMaxPicturePixels)
               : fmt::format(
                     "longitude from -360 to 360, latitude from -{0:.4f} to {0:.4f} and "
                     "zoom from 0 to {1}, such as 14.5,35.9,11",
                     kMaxLatitude, kMaxZoom);
    return Problem{400,
                   fmt::format("The address of a picture takes {}: {}.", takes, kPicturePattern),
                   centre ? "width x height" : "lon,lat,zoom", request.path[centre ? 3 : 2], takes};
  }
  const int width = size->width * name->scale;
  const int height = size->height * name->scale;
  if (std::max(width, height) > kMaxPicturePixels) return too_large(width, height);
  const auto view = view_around(centre->place, centre->zoom, width, height, name->scale);
  return WindowRequest{*std::move(layers), view,           static_cast<double>(name->scale), {},
                       name->format,       request.path[2]};
}

bool has_style(const std::vector<std::string>& path) {
  return path.size() > 3 && path[2] == "s" && (path.size() == 4 || path.size() == 6);
}

Result<WindowRequest> parse_unstyled(const DocumentRequest& request) {
  if (request.path.size() == 2) return parse_with_box(request);
  if (request.path.size() == 4) return parse_with_centre(request);
  return Problem{404, fmt::format("There is nothing here. Pictures are at {}.", kPicturePattern)};
}

}  // namespace

std::optional<WindowSides> parse_window_in_degrees(std::string_view text) {
  auto numbers = parse_four_numbers(text, 360.0 * kMostWorlds);
  if (!numbers) return std::nullopt;
  auto [west, south, east, north] = *numbers;
  if (std::abs(south) > 90 || std::abs(north) > 90) return std::nullopt;
  if (west > east) east += 360;
  const auto on_map = [](double lat) { return std::clamp(lat, -kMaxLatitude, kMaxLatitude); };
  return sides_between(grid_from_lonlat({west, on_map(south)}),
                       grid_from_lonlat({east, on_map(north)}));
}

std::optional<WindowSides> parse_window_in(const MapSystem& system, std::string_view text,
                                           AxisOrder order) {
  const auto bounds = parse_bounds(system, text, order);
  return bounds ? sides_between(system, *bounds) : std::nullopt;
}

std::optional<WindowSides> parse_window_around(const MapSystem& system, std::string_view text,
                                               AxisOrder order) {
  auto bounds = parse_bounds(system, text, order);
  if (!bounds) return std::nullopt;
  if (system.is_in_degrees) {
    if (std::abs(bounds->south) > 90 || std::abs(bounds->north) > 90) return std::nullopt;
    if (bounds->west > bounds->east) bounds->east += 360;
  }
  return sides_between(system, *bounds);
}

std::optional<int> parse_pixels(std::string_view text) {
  int pixels = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), pixels);
  const bool is_one = error == std::errc() && end == text.data() + text.size() && pixels >= 1 &&
                      pixels <= kMaxPicturePixels;
  return is_one ? std::optional(pixels) : std::nullopt;
}

Result<View> map_view(const WindowSides& sides, const DocumentRequest& request, int scale,
                      Projection projection) {
  const auto size = size_of(sides, request);
  if (!size) return size.problem();
  const int width = size->width * scale;
  const int height = size->height * scale;
  if (std::max(width, height) > kMaxPicturePixels) return too_large(width, height);
  const auto view = view_of_window(sides, width, height, projection);
  const std::string* box = request.find("bbox");
  if (!view) return bad_window(box == nullptr ? std::string() : *box);
  return *view;
}

Result<WindowRequest> parse_map_picture(const DocumentRequest& request) {
  DocumentRequest unstyled = request;
  const bool is_styled = has_style(request.path);
  if (is_styled) take_style(unstyled.path, unstyled.query);
  auto parsed = parse_unstyled(unstyled);
  if (!parsed) return parsed;
  auto styled = request.styles.read(std::move(unstyled.query), is_styled ? 404 : 400);
  if (!styled) return std::move(styled).problem();
  auto style = styled->style_for(parsed->layers, kPictureParameters);
  if (!style) return std::move(style).problem();
  parsed->style = *std::move(style);
  return parsed;
}

Problem bad_value(std::string_view parameter, const std::string& value, const std::string& takes) {
  return {400, fmt::format("The parameter {} takes {}.", parameter, takes), std::string(parameter),
          value, takes};
}

}  // namespace trapeze
