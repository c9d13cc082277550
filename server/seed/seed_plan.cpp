#include "server/seed/seed_plan.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "render/picture/webp.h"
#include "server/base/content_hash.h"
#include "server/tiles/painted_tile.h"

namespace trapeze {
namespace {

/// The column or row of a position, clamped to the existing ones.
std::uint32_t tile_at(double cells, int zoom) {
  const auto side = static_cast<double>(TileId{zoom, 0, 0}.side());
  const double last = std::ldexp(1.0, zoom) - 1;
  return static_cast<std::uint32_t>(std::clamp(std::floor((cells - kGridMin) / side), 0.0, last));
}

}  // namespace

Result<SeedPlan> SeedPlan::make(const SeedRequest& request,
                                const std::shared_ptr<const Dataset>& dataset) {
  SeedPlan plan;
  plan.zooms_ = request.zooms;
  plan.scale_ = request.tile.scale;
  const auto [west, south, east, north] = request.bbox.value_or(kWorldBounds);
  const GridPosition north_west = grid_from_lonlat({west, north});
  const GridPosition south_east = grid_from_lonlat({east, south});
  for (int zoom = 0; zoom <= request.zooms.last; ++zoom) {
    plan.columns_.push_back({tile_at(north_west.x, zoom), tile_at(south_east.x, zoom),
                             tile_at(north_west.y, zoom), tile_at(south_east.y, zoom)});
    if (zoom < request.zooms.first) continue;
    TileRequest tile = request.tile;
    tile.tile = {zoom, 0, 0};
    auto of_zoom = plan_tile(tile, dataset);
    if (!of_zoom) return std::move(of_zoom).problem();
    plan.plans_.push_back(*std::move(of_zoom));
  }
  return plan;
}

TilePlan SeedPlan::plan_of(const TileId& tile) const {
  TilePlan plan = at(tile.z);
  TileRequest request;
  request.tile = tile;
  request.scale = scale_;
  WindowRequest window = window_of(std::move(request));
  plan.view = window.view;
  plan.caption = std::move(window.caption);
  return plan;
}

bool SeedPlan::meets(const TileId& tile) const {
  const Columns& wanted = columns(tile.z);
  return wanted.first_x <= tile.x && tile.x <= wanted.last_x && wanted.first_y <= tile.y &&
         tile.y <= wanted.last_y;
}

bool SeedPlan::holds_all_below(const TileId& tile) const {
  const Columns& wanted = columns(zooms_.last);
  const int down = zooms_.last - tile.z;
  const auto is_within = [down](std::uint32_t n, std::uint32_t first, std::uint32_t last) {
    return first <= n << down && ((n + 1) << down) - 1 <= last;
  };
  return is_within(tile.x, wanted.first_x, wanted.last_x) &&
         is_within(tile.y, wanted.first_y, wanted.last_y);
}

std::uint64_t SeedPlan::count() const {
  std::uint64_t tiles = 0;
  for (int zoom = zooms_.first; zoom <= zooms_.last; ++zoom) {
    const Columns& wanted = columns(zoom);
    tiles += (std::uint64_t{wanted.last_x} - wanted.first_x + 1) *
             (std::uint64_t{wanted.last_y} - wanted.first_y + 1);
  }
  return tiles;
}

std::string SeedPlan::identity(const std::string& renderer, const std::string& fonts) const {
  ContentHash hash;
  hash.add(kPictureVersion);
  hash.add(renderer);
  for (const TilePlan& plan : plans_) hash.add(plan.key());
  const auto has_text = [](const TilePlan& plan) {
    return !plan.labels.empty() || plan.debug.any();
  };
  if (std::ranges::any_of(plans_, has_text)) hash.add(fonts);
  if (plans_.front().format == TileFormat::webp) {
    hash.add(static_cast<std::uint64_t>(webp_version()));
  }
  const Columns& wanted = columns(zooms_.last);
  for (const std::uint32_t end : {wanted.first_x, wanted.last_x, wanted.first_y, wanted.last_y}) {
    hash.add(end);
  }
  return hash.hex();
}

std::optional<GeographicBounds> parse_bbox(std::string_view text) {
  GeographicBounds bounds;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, bounds[i]);
    const bool is_last = i + 1 == bounds.size();
    if (error != std::errc() || (is_last ? rest != end : rest == end || *rest != ',')) {
      return std::nullopt;
    }
    if (!is_last) text.remove_prefix(static_cast<std::size_t>(rest - text.data()) + 1);
  }
  const auto [west, south, east, north] = bounds;
  const bool is_on_map = west >= -180 && east <= 180 && south >= -90 && north <= 90 &&
                         south < kMaxLatitude && north > -kMaxLatitude;
  if (!is_on_map || !(west < east) || !(south < north)) return std::nullopt;
  return GeographicBounds{west, std::max(south, -kMaxLatitude), east,
                          std::min(north, kMaxLatitude)};
}

}  // namespace trapeze
