// Documents about the layers, created for each request: their input and their output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/grid/web_mercator.h"
#include "render/text/fonts.h"
#include "server/base/defaults.h"
#include "server/base/limits.h"
#include "server/base/url.h"
#include "server/data/dataset.h"
#include "server/styles/style_book.h"
#include "server/tiles/tile_matrix_set.h"

namespace trapeze {

struct DocumentRequest {
  const Dataset& dataset;
  const StyleBook& styles;
  const Fonts& fonts;
  std::string base_url;                             // URL of this server, without a final '/'
  std::vector<std::string> path;                    // decoded segments, untrusted
  std::vector<QueryPair> query;                     // untrusted
  std::uint64_t map_pixels = defaults::kMapPixels;  // limit for the picture of a window
  const TileMatrixSets& sets = TileMatrixSets::built_in();
  std::size_t max_layers = kMaxLayersPerTile;  // limit for one picture
  int max_zoom = kMaxZoom;                     // pixels of a picture are not smaller than there
  /// Completes the style of the query; null: the style that the query names does.
  std::shared_ptr<const StyleQuery> named = {};

  /// The value of the first pair with that name, or null.
  const std::string* find(std::string_view name) const {
    for (const auto& [key, value] : query) {
      if (key == name) return &value;
    }
    return nullptr;
  }

  /// The style that the query sets. Problems, and the names in `others`, are those of
  /// StyleBook::read() and StyledQuery::style_for().
  Result<StyleQuery> style_for(std::span<const std::string> layers,
                               std::span<const std::string_view> others = {}) const {
    auto styled = styles.read(query);
    if (!styled) return std::move(styled).problem();
    if (named != nullptr) styled->named = named;
    return styled->style_for(layers, others);
  }
  /// The same for links in the document.
  Result<StyleLink> style_link_for(std::span<const std::string> layers,
                                   std::span<const std::string_view> others = {}) const {
    auto styled = styles.read(query);
    if (!styled) return std::move(styled).problem();
    return styled->link_for(layers, others);
  }
};

struct Document {
  std::string content_type;
  std::string bytes;
};

}  // namespace trapeze
