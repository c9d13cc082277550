// The real layers for picture tests: every FlatGeobuf file of the folder named by the environment
// variable TRAPEZE_DATA.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/grid/web_mercator.h"
#include "core/layer/layer.h"
#include "render/mask/mask.h"
#include "tests/pictures/true_picture.h"

namespace trapeze::testing {

/// Stems of the file names, in alphabetical order; kNoData alone if there is no data.
std::vector<std::string> real_layer_names();
constexpr const char* kNoData = "no_data";

struct RealLayer {
  std::unique_ptr<Layer> layer;
  TrueOutlines outlines;
};

/// Loaded on first use and kept until the process ends; null for kNoData. For use by one thread.
const RealLayer* real_layer(const std::string& name);

/// At most `count` different tiles, each around a random vertex, which depends on the seed only.
std::vector<TileId> tiles_around_vertices(const RealLayer& real, int zoom, int count,
                                          std::uint32_t seed);

/// "12/3340/1811"
std::string text_of(const TileId& tile);

/// What the server draws of a layer by default: a tolerance of a quarter of a pixel, small polygons
/// as dust.
Layer::Selection default_selection(const View& view);

}  // namespace trapeze::testing
