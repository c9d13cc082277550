// What to seed: the plan of every zoom, and the tiles wanted.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/grid/web_mercator.h"
#include "server/base/result.h"
#include "server/base/zoom_range.h"
#include "server/data/dataset.h"
#include "server/data/layer_summary.h"
#include "server/tiles/tile_plan.h"
#include "server/tiles/tile_request.h"

namespace trapeze {

struct SeedRequest {
  TileRequest tile;  // the tile id in it is ignored
  ZoomRange zooms;
  std::optional<GeographicBounds> bbox;  // tiles that intersect it are wanted; all if not set
};

/// Thread-safety: immutable, any number of threads may read.
class SeedPlan {
 public:
  /// The problem is that of plan_tile().
  static Result<SeedPlan> make(const SeedRequest& request,
                               const std::shared_ptr<const Dataset>& dataset);

  const ZoomRange& zooms() const { return zooms_; }
  /// The plan of one of the zooms, for any tile of it.
  const TilePlan& at(int zoom) const {
    return plans_[static_cast<std::size_t>(zoom - zooms_.first)];
  }
  TilePlan plan_of(const TileId& tile) const;

  /// Whether the tile or one below it is wanted; its zoom may be any up to the last.
  bool meets(const TileId& tile) const;
  /// Whether all tiles below it are wanted.
  bool holds_all_below(const TileId& tile) const;
  /// The number of wanted tiles.
  std::uint64_t count() const;

  /// Hex digits that are equal only for plans that give the same bytes: they cover data, style,
  /// zooms, bounds, format and renderer, and the fonts if there is text in the tiles.
  std::string identity(const std::string& renderer, const std::string& fonts) const;

 private:
  struct Columns {
    std::uint32_t first_x = 0;
    std::uint32_t last_x = 0;
    std::uint32_t first_y = 0;
    std::uint32_t last_y = 0;
  };

  /// For a zoom up to the last.
  const Columns& columns(int zoom) const { return columns_[static_cast<std::size_t>(zoom)]; }

  ZoomRange zooms_;
  int scale_ = 1;
  std::vector<TilePlan> plans_;   // by zoom, from the first
  std::vector<Columns> columns_;  // by zoom, from 0
};

/// Parses "W,S,E,N" in degrees, with W west of E; nothing for other text, or if the box is
/// completely off the map.
std::optional<GeographicBounds> parse_bbox(std::string_view text);

}  // namespace trapeze
