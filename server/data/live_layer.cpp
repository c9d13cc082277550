#include "server/data/live_layer.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "core/grid/web_mercator.h"
#include "core/layer/layer_contents.h"
#include "server/base/content_hash.h"

namespace trapeze {
namespace {

// Each patch makes drawing a little slower. At the first number patches are merged into one when
// there is nothing else to do, at the second one in any case.
constexpr std::size_t kManyPatches = 64;
constexpr std::size_t kMostPatches = 256;
// With more features at a time, and more than this share of all, reading everything takes less
// time.
constexpr std::size_t kManyFeatures = 10'000;
constexpr double kLargeShare = 0.1;

// Cells: borders are snapped to each other over smaller distances.
constexpr double kTouch = 4;

/// The distance, in cells, at which a feature may affect how another one is drawn.
double reach_of(const LayerConfig& config) {
  // A metre on the ground is up to 12 metres of the grid, at 85 degrees.
  constexpr double kCellsPerMetre = static_cast<double>(kGridSize) / 40'075'016.68;
  return kTouch + 12 * kCellsPerMetre * config.close_gaps.value_or(0);
}

/// The bounding boxes of its features.
std::vector<Box> places_of(const Layer& features) {
  std::vector<Box> places;
  for (std::uint32_t row = 0; row < features.features().size(); ++row) {
    Rings rings;
    features.append_outline(row, rings);
    Box& box = places.emplace_back();
    for (const Point p : rings.points) box.include(p);
  }
  return places;
}

/// The number of features that are drawn, as after a full reload: those without polygons have rows,
/// too.
std::size_t features_of(const Layer& layer) {
  std::size_t features = 0;
  for (std::uint32_t row = 0; row < layer.features().size(); ++row) {
    const RingRange rings = layer.contents().rings_of(row);
    if (!layer.is_removed(row) && rings.begin < rings.end) ++features;
  }
  return features;
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

std::optional<ServedLayer> LiveLayer::next() {
  if (is_worn_) return std::nullopt;
  const ChangeFeed::Mark mark = feed_.mark();
  const std::vector<std::int64_t> ids = feed_.take();
  try {
    const std::size_t patches = patcher_->patches();
    if (ids.empty()) return patches < kManyPatches ? std::nullopt : join_patches();
    if (patches >= kMostPatches && !join_patches()) return std::nullopt;
    return patch(ids);
  } catch (...) {
    feed_.go_back(mark);
    throw;
  }
}

std::optional<ServedLayer> LiveLayer::patch(std::span<const std::int64_t> ids) {
  const auto start = std::chrono::steady_clock::now();
  const std::optional<Reading> reading = read_changes(ids);
  is_worn_ = true;  // stays set if there is too much to apply, or if it cannot be applied
  if (!reading) return std::nullopt;
  const Layer& features = *reading->features.layer;
  LayerChanges changes = patcher_->apply({reading->ids, features});
  is_worn_ = false;
  changed_.insert(ids.begin(), ids.end());
  take_step(std::move(changes), *reading);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  spdlog::info(fmt::format("layer \"{}\": {} features have changed, {} were rebuilt, {:.0f} ms",
                           config_.name, ids.size(), features.features().size(), took.count()));
  if (const std::size_t skipped = reading->features.report.skipped; skipped > 0) {
    spdlog::warn(fmt::format("layer \"{}\": {} of them were skipped", config_.name, skipped));
  }
  return served_;
}

/// Merges all patches into one. If that is not possible, the layer will be read in full, and is
/// served as it is until then.
std::optional<ServedLayer> LiveLayer::join_patches() {
  const std::vector<std::int64_t> changed(changed_.begin(), changed_.end());
  is_worn_ = true;
  patcher_->start_over();
  const std::optional<Reading> reading = read_changes(changed);
  if (!reading) return std::nullopt;
  patcher_->apply({reading->ids, *reading->features.layer});
  is_worn_ = false;
  // Nothing should look different, but features are read as they are now: with changes that have
  // not been reported yet.
  take_step(std::nullopt, *reading);
  return served_;
}

void LiveLayer::take_step(std::optional<LayerChanges> changes, const Reading& reading) {
  std::shared_ptr<ServedLayer::Step> step;
  if (changes) {
    step = std::make_shared<ServedLayer::Step>();
    step->since = served_.revision;
    step->changes = *std::move(changes);
  }
  ContentHash hash;
  hash.add(served_.revision);
  // Which features were replaced: those that were removed are not among the features read.
  for (const std::int64_t id : reading.ids) hash.add(static_cast<std::uint64_t>(id));
  hash.add(revision_of(*reading.features.layer));
  hash.add(changes_taken_++);
  served_.revision = hash.value();
  served_.layer = patcher_->now();
  served_.report.loaded = features_of(*served_.layer);
  served_.last_step = std::move(step);
}

std::optional<LiveLayer::Reading> LiveLayer::read_changes(
    std::span<const std::int64_t> changed) const {
  const auto is_much = [this](std::size_t features) {
    const auto all = static_cast<double>(patcher_->now()->features().size());
    return features > kManyFeatures && static_cast<double>(features) > kLargeShare * all;
  };
  if (is_much(changed.size())) return std::nullopt;
  LoadedLayer features = read(changed);
  std::vector<std::int64_t> ids =
      patcher_->ids_to_build(changed, places_of(*features.layer), reach_of(config_));
  if (is_much(ids.size())) return std::nullopt;
  if (!std::ranges::equal(ids, changed)) features = read(ids);
  return Reading{std::move(ids), std::move(features)};
}

LoadedLayer LiveLayer::read(std::span<const std::int64_t> ids) const {
  OpenOptions options = how_to_open(config_);
  options.selection.ids.emplace(ids.begin(), ids.end());
  return open_layer(config_.file, options);
}

}  // namespace trapeze
