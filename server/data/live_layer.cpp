#include "server/data/live_layer.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "core/grid/web_mercator.h"
#include "server/base/content_hash.h"

namespace trapeze {
namespace {

// Each makes drawing a little slower.
constexpr std::size_t kMostPatches = 256;
// Beyond so many features at once, and this share of all, reading all takes less time.
constexpr std::size_t kManyFeatures = 10'000;
constexpr double kLargeShare = 0.1;

// Cells: borders are snapped to each other over less.
constexpr double kTouch = 4;

/// In cells, from which a feature may be drawn otherwise because of another.
double reach_of(const LayerConfig& config) {
  // What is a metre on the ground is up to 12 of the grid, at 85 degrees.
  constexpr double kCellsPerMetre = static_cast<double>(kGridSize) / 40'075'016.68;
  return kTouch + 12 * kCellsPerMetre * config.close_gaps.value_or(0);
}

}  // namespace

LiveLayer::LiveLayer(const LayerConfig& config)
    : config_(config), feed_(config.file, config.live_query) {}

ServedLayer LiveLayer::begin(ServedLayer read) {
  try {
    patcher_.emplace(*read.layer);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(
        fmt::format("layer \"{}\" cannot be live: {}", config_.name, error.what()));
  }
  read.layer = patcher_->first();
  read.whole = patcher_->first();
  served_ = std::move(read);
  return served_;
}

bool LiveLayer::is_worn() const {
  return is_worn_ || patcher_->patches() >= kMostPatches;
}

std::optional<ServedLayer> LiveLayer::next() {
  const ChangeFeed::Mark mark = feed_.mark();
  const std::vector<std::int64_t> ids = feed_.take();
  if (ids.empty()) return std::nullopt;
  try {
    return patch(ids);
  } catch (...) {
    feed_.go_back(mark);
    throw;
  }
}

std::optional<ServedLayer> LiveLayer::patch(std::span<const std::int64_t> ids) {
  const auto start = std::chrono::steady_clock::now();
  const auto is_much = [this](std::size_t features) {
    const auto all = static_cast<double>(patcher_->now()->features().size());
    return features > kManyFeatures && static_cast<double>(features) > kLargeShare * all;
  };
  is_worn_ = is_much(ids.size());
  if (is_worn_) return std::nullopt;
  LoadedLayer changed = read(ids);
  const std::vector<std::int64_t> to_build =
      patcher_->ids_to_build(ids, places_of(*changed.layer), reach_of(config_));
  is_worn_ = is_much(to_build.size());
  if (is_worn_) return std::nullopt;
  if (!std::ranges::equal(to_build, ids)) changed = read(to_build);
  ServedLayer next = served_;
  auto step = std::make_shared<ServedLayer::Step>();
  step->since = served_.revision;
  step->changes = patcher_->apply({to_build, ids, *changed.layer});
  ContentHash hash;
  hash.add(served_.revision);
  for (const std::int64_t id : to_build) hash.add(static_cast<std::uint64_t>(id));
  hash.add(revision_of(*changed.layer));
  next.revision = hash.value();
  next.layer = patcher_->now();
  next.last_step = std::move(step);
  served_ = std::move(next);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  spdlog::info("layer \"{}\": {} features have changed, {} were built anew, {:.0f} ms",
               config_.name, ids.size(), changed.layer->features().size(), took.count());
  if (changed.report.skipped > 0) {
    spdlog::warn("layer \"{}\": {} of them were skipped", config_.name, changed.report.skipped);
  }
  return served_;
}

std::vector<Box> LiveLayer::places_of(const Layer& features) const {
  std::vector<Box> places;
  for (std::uint32_t row = 0; row < features.features().size(); ++row) {
    Rings rings;
    features.append_outline(row, rings);
    Box& box = places.emplace_back();
    for (const Point p : rings.points) box.include(p);
  }
  return places;
}

LoadedLayer LiveLayer::read(std::span<const std::int64_t> ids) const {
  OpenOptions options = how_to_open(config_);
  options.selection.ids.emplace(ids.begin(), ids.end());
  return open_layer(config_.file, options);
}

}  // namespace trapeze
