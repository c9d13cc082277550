// Pictures of windows of the map:
//
//   /map/{layers}[@{1-4}x].{png,webp}?bbox=W,S,E,N[&width=][&height=][&crs=]
//   /map/{layers}/{lon},{lat},{zoom}/{width}x{height}[@{1-4}x].{png,webp}
//
// with /s/{style} after the layers for a style that has a name, as tiles have it.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/tiles/map_system.h"
#include "server/tiles/map_window.h"
#include "server/tiles/window_request.h"

namespace trapeze {

/// The picture that is asked for. Width and height are in pixels of scale 1: a picture @2x has
/// twice as many. Where one of them is missing, it follows from the sides of the window; without
/// both, the longer side has 1024 pixels. The problem is 400 for what is malformed, 404 for another
/// path or a style in the path that there is not.
Result<WindowRequest> parse_map_picture(const DocumentRequest& request);

/// The picture of the window, with `width` and `height` of the query or what follows from the
/// sides, as parse_map_picture() has it.
Result<View> map_view(const WindowSides& sides, const DocumentRequest& request, int scale = 1,
                      Projection projection = Projection::mercator);

/// "west,south,east,north" in degrees, of a window of Web Mercator. Where the west is east of the
/// east, the window goes over the antimeridian; latitudes beyond the ends of the map are taken for
/// these. Nothing if it is not four numbers, or if the window has no width or no height.
std::optional<WindowSides> parse_window_in_degrees(std::string_view text);
/// Which of the two axes a box has first: east, or that of the authority of the system.
enum class AxisOrder : std::uint8_t { east_first, of_authority };

/// In units of the system, as they are: "west,south,east,north", or "south,west,north,east".
/// Nothing as above.
std::optional<WindowSides> parse_window_in(const MapSystem& system, std::string_view text,
                                           AxisOrder order);
/// The same, but in degrees, a window whose west is east of its east goes over the antimeridian,
/// and latitudes are at most 90.
std::optional<WindowSides> parse_window_around(const MapSystem& system, std::string_view text,
                                               AxisOrder order);

/// A length in pixels of a picture, from 1 to kMaxPicturePixels.
std::optional<int> parse_pixels(std::string_view text);

}  // namespace trapeze
