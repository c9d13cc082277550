#include "server/changes/change_log.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <iterator>
#include <map>
#include <new>
#include <set>
#include <tuple>
#include <utility>

#include "server/base/failure_words.h"
#include "server/base/json_text.h"
#include "server/changes/run_command.h"
#include "server/tiles/layer_style.h"

namespace trapeze {
namespace {

constexpr std::size_t kMostSteps = 32;
constexpr std::ptrdiff_t kMostWaitingApart = 4;   // for comparison, with memory of their own
constexpr auto kPause = std::chrono::seconds(1);  // after memory has run out

std::string text_of(const TileId& tile) {
  return fmt::format("{}/{}/{}", tile.z, tile.x, tile.y);
}

/// Leaves out all zooms from the first one on with more listed tiles than that.
void limit_tiles(std::size_t most_tiles, ChangedLayer& layer) {
  std::map<int, std::size_t> tiles_of;
  for (const TileId& tile : layer.tiles.tiles) ++tiles_of[tile.z];
  for (const auto& [zoom, tiles] : tiles_of) {
    if (tiles <= most_tiles) continue;
    layer.is_everything = layer.is_everything || zoom == layer.tiles.zooms.first;
    layer.tiles.is_complete = false;
    if (!layer.is_everything) {
      layer.tiles.zooms.last = std::min(layer.tiles.zooms.last, zoom - 1);
    }
    return;
  }
}

/// Combines the changes of consecutive steps into one.
void add(const ChangedLayer& more, std::size_t most_tiles, ChangedLayer& sum) {
  sum.is_everything = sum.is_everything || more.is_everything;
  sum.tiles.is_complete = sum.tiles.is_complete && more.tiles.is_complete;
  sum.tiles.zooms.last = std::min(sum.tiles.zooms.last, more.tiles.zooms.last);
  std::vector<TileId>& tiles = sum.tiles.tiles;
  tiles.insert(tiles.end(), more.tiles.tiles.begin(), more.tiles.tiles.end());
  const auto place = [](const TileId& tile) { return std::tuple(tile.z, tile.y, tile.x); };
  std::ranges::sort(tiles, {}, place);
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  limit_tiles(most_tiles, sum);
  std::erase_if(tiles, [&](const TileId& tile) {
    return sum.is_everything || tile.z > sum.tiles.zooms.last;
  });
}

void add(const std::vector<ChangedLayer>& more, std::size_t most_tiles,
         std::map<std::string, ChangedLayer>& sum) {
  for (const ChangedLayer& layer : more) {
    const auto [there, is_new] = sum.emplace(layer.name, layer);
    if (!is_new) add(layer, most_tiles, there->second);
  }
}

std::vector<ChangedLayer> in_order(const std::map<std::string, ChangedLayer>& by_name) {
  std::vector<ChangedLayer> layers;
  layers.reserve(by_name.size());
  for (const auto& [name, layer] : by_name) layers.push_back(layer);
  return layers;
}

/// The ids of the table that the layer's own style joins, in all languages; empty if it joins none.
std::string table_of(const ServedLayer& layer) {
  const ParameterValue* values = layer.config.style.find({}, ParameterId::values);
  if (values == nullptr || layer.tables == nullptr) return {};
  const auto named = layer.tables->find(std::get<TableChoice>(*values).name);
  if (named == layer.tables->end()) return {};
  std::string ids = named->second.table->id();
  for (const auto& [language, table] : named->second.languages) {
    ids += " " + language + " " + table->id();
  }
  return ids;
}

/// Whether the layer's tiles may look different without a style in the request although its
/// features are the same: because of changes of its own style, its zooms, its default fill, or any
/// of the values by which it is coloured, since classes depend on all of them.
bool is_shown_otherwise(const ServedLayer& before, std::size_t position_before,
                        const ServedLayer& after, std::size_t position_after) {
  const LayerConfig& old = before.config;
  const LayerConfig& now = after.config;
  return old.style.canonical_text() != now.style.canonical_text() || old.min_zoom != now.min_zoom ||
         old.max_zoom != now.max_zoom ||
         default_fill(old, position_before) != default_fill(now, position_after) ||
         table_of(before) != table_of(after);
}

}  // namespace

std::set<std::string> ChangeLog::names_of(const Step& step) {
  std::set<std::string> names;
  for (const auto* dataset : {step.before.get(), step.after.get()}) {
    for (const ServedLayer& layer : dataset->layers()) names.insert(layer.config.name);
  }
  return names;
}

/// Which tiles of the layer may look different, without comparing tiles.
ChangeLog::Change ChangeLog::change_of(const Step& step, const std::string& name) {
  const auto before = step.before->find(name);
  const auto after = step.after->find(name);
  if (!before || !after) return Change::of_all_tiles;
  const ServedLayer& old = step.before->layers()[*before];
  const ServedLayer& now = step.after->layers()[*after];
  if (is_shown_otherwise(old, *before, now, *after)) return Change::of_all_tiles;
  return old.revision == now.revision ? Change::none : Change::of_some_tiles;
}

ChangeLog::ChangeLog(Options options) : options_(std::move(options)) {
  try {
    comparing_ = std::thread([this] { compare_steps(); });
    if (!options_.command.empty()) telling_ = std::thread([this] { tell_command(); });
  } catch (...) {
    stop();
    throw;
  }
}

ChangeLog::~ChangeLog() {
  stop();
}

void ChangeLog::stop() {
  end_command();
  if (comparing_.joinable()) comparing_.join();
}

void ChangeLog::end_command() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_all();
  if (telling_.joinable()) telling_.join();
}

bool ChangeLog::is_comparing() const {
  const std::lock_guard lock(mutex_);
  return is_comparing_;
}

void ChangeLog::note(std::shared_ptr<const Dataset> before, std::shared_ptr<const Dataset> after,
                     Memory memory) {
  if (before->generation() == after->generation()) return;
  auto step = std::make_shared<Step>();
  step->since = before->generation();
  step->generation = after->generation();
  step->before = std::move(before);
  step->after = std::move(after);
  step->memory = memory;
  {
    const std::lock_guard lock(mutex_);
    steps_.push_back(std::move(step));
    combine_waiting();
    if (steps_.size() > kMostSteps) steps_.pop_front();  // has been compared, or is being compared
  }
  wake_.notify_all();
}

/// Merges the oldest of too many steps that wait into the next one, so that the command is notified
/// of both and the state between them is not kept. Clients may have tiles of that state: even if
/// there is no difference between those before and after it, what it changed has changed.
void ChangeLog::combine_waiting() {
  const auto oldest =
      std::ranges::find_if(steps_, [](const auto& each) { return !each->is_taken; });
  const auto apart = std::count_if(oldest, steps_.end(),
                                   [](const auto& each) { return each->memory == Memory::apart; });
  const auto waiting = static_cast<std::size_t>(std::distance(oldest, steps_.end()));
  if (waiting < 2 || (apart <= kMostWaitingApart && waiting < kMostSteps)) return;
  Step& step = **oldest;
  Step& next = **std::next(oldest);
  for (const std::string& name : names_of(step)) {
    if (change_of(step, name) != Change::none) step.in_full.insert(name);
  }
  next.in_full.merge(step.in_full);
  if (step.memory == Memory::apart) next.memory = Memory::apart;
  next.since = step.since;
  next.before = step.before;
  steps_.erase(oldest);
}

void ChangeLog::compare_steps() {
  while (true) {
    std::shared_ptr<Step> step;
    {
      std::unique_lock lock(mutex_);
      const auto next = [this] {
        return std::ranges::find_if(steps_, [](const auto& each) { return !each->is_taken; });
      };
      wake_.wait(lock, [&] { return is_stopping_ || next() != steps_.end(); });
      if (is_stopping_) return;
      step = *next();
      step->is_taken = true;
      is_comparing_ = true;
    }
    // If memory runs out, which is likely while layers are reloaded, the step is compared again.
    try {
      take_changes(*step, compare(*step));
    } catch (const std::bad_alloc& error) {
      log_failure("changes cannot be determined at the moment", error);
      std::unique_lock lock(mutex_);
      is_comparing_ = false;
      wake_.wait_for(lock, kPause, [this] { return is_stopping_; });
      step->is_taken = false;
    }
    wake_.notify_all();
  }
}

void ChangeLog::take_changes(Step& step, std::vector<ChangedLayer> layers) {
  const std::lock_guard lock(mutex_);
  if (!options_.command.empty()) {
    Sum sum = untold_ ? *untold_ : Sum{step.since, {}, {}};
    sum.generation = step.generation;
    add(layers, options_.most_tiles, sum.layers);
    untold_ = std::move(sum);
  }
  step.layers = std::move(layers);
  step.is_compared = true;
  is_comparing_ = false;
  step.before = nullptr;
  step.after = nullptr;
}

std::vector<ChangedLayer> ChangeLog::compare(const Step& step) const {
  std::set<std::string> names = names_of(step);
  names.insert(step.in_full.begin(), step.in_full.end());
  std::vector<ChangedLayer> layers;
  for (const std::string& name : names) {
    const Change change =
        step.in_full.contains(name) ? Change::of_all_tiles : change_of(step, name);
    if (change == Change::none) continue;
    ChangedLayer layer;
    layer.name = name;
    layer.tiles.zooms = options_.zooms;
    if (change == Change::of_all_tiles) {
      layer.is_everything = true;
    } else {
      ChangeRequest request;
      request.tile.layers = {name};
      request.zooms = options_.zooms;
      request.most_scale = options_.most_scale;
      request.certainty = Certainty::candidates;
      request.most_tiles = options_.most_tiles;
      request.labels = options_.labels;
      try {
        auto found = changed_tiles(request, step.before, step.after);
        layer.is_everything = !found;
        if (found) layer.tiles = *std::move(found);
      } catch (const std::exception& error) {  // when memory runs out
        spdlog::error(fmt::format("changes of layer {}: {}", name, failure_words(error)));
        layer.is_everything = true;
      }
    }
    spdlog::info(fmt::format(
        "{}: {} from generation {} to {}", name,
        layer.is_everything
            ? "all tiles may look different"
            : fmt::format("{} tiles of zooms {} to {} may look different", layer.tiles.tiles.size(),
                          layer.tiles.zooms.first, layer.tiles.zooms.last),
        step.since, step.generation));
    layers.push_back(std::move(layer));
  }
  return layers;
}

void ChangeLog::tell_command() {
  while (true) {
    Sum changes;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return is_stopping_ || untold_; });
      if (is_stopping_) return;
      changes = *std::exchange(untold_, std::nullopt);
    }
    run_command(changes);
  }
}

void ChangeLog::run_command(const Sum& changes) {
  const auto is_stopping = [this] {
    const std::lock_guard lock(mutex_);
    return is_stopping_;
  };
  try {
    const int status = trapeze::run_command(
        options_.command,
        {{"TRAPEZE_SINCE", changes.since}, {"TRAPEZE_GENERATION", changes.generation}},
        change_lines(in_order(changes.layers)), is_stopping);
    if (status != 0) spdlog::error(fmt::format("changes.command exited with status {}", status));
  } catch (const std::exception& error) {
    spdlog::error(fmt::format("changes.command cannot be run: {}", failure_words(error)));
  }
}

ChangeLog::Answer ChangeLog::between(std::string_view since, std::string_view generation) const {
  if (since == generation) return {Answer::State::known, {}};
  const std::lock_guard lock(mutex_);
  // The last time that the data was in that state, as the same state may occur again.
  const auto first = std::find_if(steps_.rbegin(), steps_.rend(),
                                  [&](const auto& step) { return step->since == since; });
  if (first == steps_.rend()) return {};
  std::map<std::string, ChangedLayer> by_name;
  for (auto step = std::prev(first.base()); step != steps_.end(); ++step) {
    if (!(*step)->is_compared) return {Answer::State::pending, {}};
    add((*step)->layers, options_.most_tiles, by_name);
    if ((*step)->generation != generation) continue;
    return {Answer::State::known, in_order(by_name)};
  }
  return {Answer::State::pending, {}};  // being served, and noted in a moment
}

std::string change_lines(const std::vector<ChangedLayer>& layers) {
  std::string lines;
  const auto out = std::back_inserter(lines);
  for (const ChangedLayer& layer : layers) {
    if (layer.is_everything) {
      fmt::format_to(out, "{} {}/*\n", layer.name, layer.tiles.zooms.first);
      continue;
    }
    for (const TileId& tile : layer.tiles.tiles) {
      fmt::format_to(out, "{} {}\n", layer.name, text_of(tile));
    }
    if (!layer.tiles.is_complete) {
      fmt::format_to(out, "{} {}/*\n", layer.name, layer.tiles.zooms.last + 1);
    }
  }
  return lines;
}

std::string changes_json(std::string_view since, std::string_view generation,
                         const std::vector<ChangedLayer>& layers) {
  Json json;
  json["since"] = since;
  json["generation"] = generation;
  json["layers"] = Json::array();
  for (const ChangedLayer& layer : layers) {
    Json tiles = Json::array();
    for (const TileId& tile : layer.tiles.tiles) tiles.push_back(text_of(tile));
    const bool is_all = layer.is_everything;
    Json all_from = nullptr;
    if (is_all || !layer.tiles.is_complete) {
      all_from = is_all ? layer.tiles.zooms.first : layer.tiles.zooms.last + 1;
    }
    json["layers"].push_back({{"name", layer.name}, {"tiles", tiles}, {"all_from_zoom", all_from}});
  }
  return to_text(json);
}

}  // namespace trapeze
