// What is to be seeded: the plan of every zoom, and the tiles of it that are wanted.
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
  TileRequest tile;  // its tile is not looked at
  ZoomRange zooms;
  std::optional<GeographicBounds> bbox;  // tiles that meet it are wanted; all if it is not set
};

/// Thread-safety: immutable, any number of threads may read.
class SeedPlan {
 public:
  /// The problem is that of plan_tile().
  static Result<SeedPlan> make(const SeedRequest& request,
                               const std::shared_ptr<const Dataset>& dataset);

  const ZoomRange& zooms() const { return zooms_; }
  /// Of one of the zooms, for any tile of it.
  const TilePlan& at(int zoom) const {
    return plans_[static_cast<std::size_t>(zoom - zooms_.first)];
  }
  TilePlan plan_of(const TileId& tile) const;

  /// Whether the tile, of any zoom up to the last, is wanted, or one below it.
  bool meets(const TileId& tile) const;
  /// Whether all tiles below it are wanted.
  bool holds_all_below(const TileId& tile) const;
  /// How many tiles are wanted.
  std::uint64_t count() const;

  /// Hex digits that are equal only for plans that lead to the same bytes: of the data, style,
  /// zooms, bounds, format and renderer.
  std::string identity(const std::string& renderer) const;

 private:
  struct Columns {
    std::uint32_t first_x = 0;
    std::uint32_t last_x = 0;
    std::uint32_t first_y = 0;
    std::uint32_t last_y = 0;
  };

  /// Of a zoom up to the last.
  const Columns& columns(int zoom) const { return columns_[static_cast<std::size_t>(zoom)]; }

  ZoomRange zooms_;
  int scale_ = 1;
  std::vector<TilePlan> plans_;   // by zoom, from the first
  std::vector<Columns> columns_;  // by zoom, from 0 on
};

/// "W,S,E,N" in degrees, W being west of E; nothing if it is something else, or lies wholly beyond
/// the map.
std::optional<GeographicBounds> parse_bbox(std::string_view text);

}  // namespace trapeze
