#include "server/seed/job_painter.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "server/seed/hilbert_order.h"

namespace trapeze {
namespace {

/// From 32 hex digits.
Digest digest_of_hex(std::string_view hex) {
  const auto word = [](std::string_view digits) {
    std::uint64_t value = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    return value;
  };
  return {word(hex.substr(16)), word(hex.substr(0, 16))};
}

}  // namespace

JobPainter::JobPainter(const SeedPlan& plan, TilePainter painter,
                       const std::shared_ptr<FeatureClassCache>& classes,
                       const std::shared_ptr<LabelBook>& labels, FindKnown find_known)
    : plan_(plan),
      painter_(std::move(painter)),
      known_(plan, classes, labels),
      find_known_(std::move(find_known)),
      approached_(static_cast<std::size_t>(plan.zooms().last) + 1) {
  TilePlan nothing = plan.at(plan.zooms().first);
  nothing.layers.clear();
  nothing.labels.clear();
  nothing.debug = {};
  nothing.background = kTransparent;
  const PaintJob job{&nothing};
  empty_ = *painter_.paint({&job, 1}).front().value().bytes;
}

SeedBlockBuilder JobPainter::paint(std::span<const SeedUnit> units) {
  block_ = {};
  contents_.clear();
  of_one_colour_.clear();
  as_they_were_.clear();
  for (const SeedUnit& unit : units) {
    approach(unit.tile);
    if (unit.is_subtree) {
      visit(unit.tile);
    } else if (const auto& look = known_.look_at_zoom(unit.tile.z)) {
      add_known(unit.tile, places_below(unit.tile, unit.tile.z), unit.tile.z, *look);
    } else {
      paint_tile(unit.tile);
    }
  }
  return std::move(block_);
}

// From the top, without the tiles already examined for the previous unit.
void JobPainter::approach(const TileId& tile) {
  for (int zoom = 0; zoom <= tile.z; ++zoom) {
    const TileId above{zoom, tile.x >> (tile.z - zoom), tile.y >> (tile.z - zoom)};
    std::optional<TileId>& approached = approached_[static_cast<std::size_t>(zoom)];
    if (approached == above && zoom < tile.z) continue;
    known_.look_at(above);
    approached = above;
  }
}

void JobPainter::visit(const TileId& tile) {
  if (known_.is_known()) return add_all_below(tile);
  if (tile.z >= plan_.zooms().first) {
    if (const auto& look = known_.look_at_zoom(tile.z)) {
      add_known(tile, places_below(tile, tile.z), tile.z, *look);
    } else {
      paint_tile(tile);
    }
  }
  if (tile.z == plan_.zooms().last) return;
  for (const TileId& child : children_in_order(tile)) {
    if (!plan_.meets(child)) continue;
    known_.look_at(child);
    approached_[static_cast<std::size_t>(child.z)] = child;
    visit(child);
  }
}

// All tiles below this one are known, but possibly not all are wanted.
void JobPainter::add_all_below(const TileId& tile) {
  const ZoomRange zooms = plan_.zooms();
  const auto add = [this](const TileId& each, int zoom) {
    add_known(each, places_below(each, zoom), zoom, known_.look_at_zoom(zoom).value());
  };
  if (plan_.holds_all_below(tile)) {
    for (int zoom = std::max(tile.z, zooms.first); zoom <= zooms.last; ++zoom) add(tile, zoom);
    return;
  }
  if (tile.z >= zooms.first) add(tile, tile.z);
  if (tile.z == zooms.last) return;
  for (const TileId& child : children_in_order(tile)) {
    if (plan_.meets(child)) add_all_below(child);
  }
}

void JobPainter::add_known(const TileId& tile, const PlaceRange& places, int zoom,
                           const TileLook& look) {
  auto content = contents_.find(look);
  if (content == contents_.end()) {
    auto bytes = looks_.find(look);
    const TilePlan plan = plan_.plan_of(zoom == tile.z ? tile : tile_at_place(zoom, places.first));
    if (bytes == looks_.end()) {
      std::string fingerprint;
      bytes = looks_.emplace(look, paint_whole(plan, fingerprint, {}).bytes).first;
    }
    const std::uint64_t number = block_.add_content(bytes->second, is_empty(plan, bytes->second));
    content = contents_.emplace(look, number).first;
  }
  block_.add_tiles(zoom, places, content->second);
  block_.figures.known += places.count;
}

void JobPainter::paint_tile(const TileId& tile) {
  const TilePlan plan = plan_.plan_of(tile);
  const PlaceRange place = places_below(tile, tile.z);
  std::string fingerprint;
  std::optional<std::uint64_t> content;
  std::optional<std::string> known;
  const auto is_wanted = [&](const std::string& hex) {
    const Digest digest = digest_of_hex(hex);
    content = block_.find(digest);
    if (!content && find_known_) known = find_known_(digest);
    return !content && !known;
  };
  Painted painted = paint_whole(plan, fingerprint, is_wanted);
  const Digest digest = digest_of_hex(fingerprint);
  if (known) {
    painted.bytes = *std::move(known);
    as_they_were_.insert(digest);
  }
  if (!content) {
    content = block_.add_content(painted.bytes, is_empty(plan, painted.bytes));
    block_.add_fingerprint(digest, *content);
    if (painted.hint != TileHint::none) of_one_colour_.insert(*content);
  }
  block_.add_tiles(tile.z, place, *content);
  if (as_they_were_.contains(digest)) {
    ++reused_;
    ++block_.figures.drawn;
  } else {
    ++(of_one_colour_.contains(*content) ? block_.figures.alone : block_.figures.drawn);
  }
}

// As in the server, large tiles are painted in bands.
JobPainter::Painted JobPainter::paint_whole(
    const TilePlan& plan, std::string& fingerprint,
    const std::function<bool(const std::string&)>& is_wanted) {
  const PaintJob job{&plan, nullptr, is_wanted};
  const int bands = TilePainter::bands_of(plan);
  PaintedTile tile;
  if (bands == 1) {
    tile = painter_.paint({&job, 1}).front().value();
    fingerprint = tile.fingerprint;
  } else {
    fingerprint = painter_.identify(job);
    if (is_wanted && !is_wanted(fingerprint)) return {};
    std::vector<PaintedBand> painted;
    painted.reserve(static_cast<std::size_t>(bands));
    for (int band = 0; band < bands; ++band) {
      painted.push_back(painter_.paint_band(job, band).value());
    }
    tile = painter_.join(plan, painted);
  }
  if (tile.bytes == nullptr) return {};
  return {*tile.bytes, tile.hint};
}

bool JobPainter::is_empty(const TilePlan& plan, const std::string& bytes) const {
  return plan.background.a == 0 && bytes == empty_;
}

}  // namespace trapeze
