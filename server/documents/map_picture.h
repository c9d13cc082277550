// Pictures of windows of the map:
//
//   /map/{layers}[@{1-4}x].{png,webp}?bbox=W,S,E,N[&width=][&height=][&crs=]
//   /map/{layers}/{lon},{lat},{zoom}/{width}x{height}[@{1-4}x].{png,webp}
//
// with /s/{style} after the layers for a named style, as in tile URLs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/problem.h"
#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/tiles/map_system.h"
#include "server/tiles/map_window.h"
#include "server/tiles/window_request.h"

namespace trapeze {

/// The requested picture. Width and height are in pixels of scale 1: a picture @2x has twice as
/// many. If one of them is missing, it follows from the sides of the window; without both, the
/// longer side has 1024 pixels. The problem is 400 for a malformed request, 404 for another path or
/// an unknown style in the path.
Result<WindowRequest> parse_map_picture(const DocumentRequest& request);

/// The picture of the window, with `width` and `height` from the query or determined from the sides
/// as in parse_map_picture().
Result<View> map_view(const WindowSides& sides, const DocumentRequest& request, int scale = 1,
                      Projection projection = Projection::mercator);

/// Parses "west,south,east,north" in degrees, as a window of Web Mercator. If west is greater than
/// east, the window crosses the antimeridian; latitudes beyond the ends of the map are clamped.
/// Nothing if it is not four numbers, or if the window has no width or no height.
std::optional<WindowSides> parse_window_in_degrees(std::string_view text);
/// The axis order of a box: east first, or as the authority of the system defines it.
enum class AxisOrder : std::uint8_t { east_first, of_authority };

/// In units of the system, without changes: "west,south,east,north", or "south,west,north,east".
/// Nothing as above.
std::optional<WindowSides> parse_window_in(const MapSystem& system, std::string_view text,
                                           AxisOrder order);
/// The same, except that in degrees, a window whose west is greater than its east crosses the
/// antimeridian, and latitudes are clamped to 90.
std::optional<WindowSides> parse_window_around(const MapSystem& system, std::string_view text,
                                               AxisOrder order);

/// A length in pixels of a picture, from 1 to kMaxPicturePixels.
std::optional<int> parse_pixels(std::string_view text);

/// The problem of a parameter whose value is not one of those that it takes.
Problem bad_value(std::string_view parameter, const std::string& value, const std::string& takes);

}  // namespace trapeze
