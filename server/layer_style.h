// How one layer is to be drawn: a request's style, and what the configuration says where it is
// silent, resolved into types.
#pragma once

#include <cstddef>

#include "render/colour.h"
#include "server/config.h"
#include "server/style_parameters.h"

namespace trapeze {

struct LayerStyle {
  Rgba fill;  // its opacity included
};

/// `position` is that of the layer in the dataset.
LayerStyle layer_style(const StyleQuery& query, const LayerConfig& config, std::size_t position);

/// What fills the layer at `position` of the dataset if a request does not say.
Rgba default_fill(const LayerConfig& config, std::size_t position);

}  // namespace trapeze
