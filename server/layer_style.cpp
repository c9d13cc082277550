#include "server/layer_style.h"

#include <array>

namespace trapeze {
namespace {

// Colours of layers that were given none: muted, told apart, readable over each other.
constexpr std::array<Rgba, 8> kPalette = {{{0x7f, 0xa6, 0x87, 255},
                                           {0x6f, 0xa8, 0xc9, 255},
                                           {0xd9, 0x9b, 0x6c, 255},
                                           {0x9d, 0x87, 0xb8, 255},
                                           {0xd7, 0xb9, 0x5b, 255},
                                           {0xc6, 0x7b, 0x82, 255},
                                           {0x62, 0xa6, 0xa0, 255},
                                           {0x94, 0x8b, 0x80, 255}}};

Rgba fill_of_layer(const StyleQuery& query, const LayerConfig& config, std::size_t position) {
  Rgba fill = default_fill(config, position);
  if (const auto value = query.value_for(config.name, ParameterId::fill)) {
    fill = std::get<Rgba>(*value);
  }
  double opacity = config.style.fill_opacity;
  if (const auto value = query.value_for(config.name, ParameterId::fill_opacity)) {
    opacity = std::get<double>(*value);
  }
  return with_opacity(fill, opacity);
}

}  // namespace

LayerStyle layer_style(const StyleQuery& query, const LayerConfig& config, std::size_t position) {
  return {fill_of_layer(query, config, position)};
}

Rgba default_fill(const LayerConfig& config, std::size_t position) {
  return config.style.fill.value_or(kPalette[position % kPalette.size()]);
}

}  // namespace trapeze
