// A request for a picture of a window of the map, as types.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "render/mask/mask.h"
#include "server/styles/style_parameters.h"
#include "server/tiles/tile_request.h"

namespace trapeze {

/// A picture of any place and size.
struct WindowRequest {
  std::vector<std::string> layers;  // valid names, each once, bottom first
  View view;
  double scale = 1;  // > 0, of lines and patterns
  StyleQuery style;
  TileFormat format = TileFormat::png;
  std::string caption = {};  // for debug=tile
  MapSystemPtr system = web_mercator();
};

/// The window of a tile.
WindowRequest window_of(TileRequest tile);

/// A request for a picture.
using PictureRequest = std::variant<TileRequest, WindowRequest>;

}  // namespace trapeze
