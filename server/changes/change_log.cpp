#include "server/changes/change_log.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <iterator>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "server/base/failure_words.h"
#include "server/base/json_text.h"
#include "server/changes/run_command.h"

namespace trapeze {
namespace {

constexpr std::size_t kMostSteps = 32;
constexpr std::size_t kMostTiles = 100'000;  // of one zoom, layer and step

std::string text_of(const TileId& tile) {
  return fmt::format("{}/{}/{}", tile.z, tile.x, tile.y);
}

/// The changes of several steps that follow each other, as if they were one.
void add(const ChangedLayer& more, ChangedLayer& sum) {
  sum.is_everything = sum.is_everything || more.is_everything;
  sum.tiles.is_complete = sum.tiles.is_complete && more.tiles.is_complete;
  sum.tiles.zooms.last = std::min(sum.tiles.zooms.last, more.tiles.zooms.last);
  std::vector<TileId>& tiles = sum.tiles.tiles;
  tiles.insert(tiles.end(), more.tiles.tiles.begin(), more.tiles.tiles.end());
  const auto place = [](const TileId& tile) { return std::tuple(tile.z, tile.y, tile.x); };
  std::ranges::sort(tiles, {}, place);
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  std::erase_if(tiles, [&](const TileId& tile) {
    return sum.is_everything || tile.z > sum.tiles.zooms.last;
  });
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

/// Whether the values have changed by which it is coloured: anywhere, as classes are of all of
/// them.
bool has_other_values(const ServedLayer& before, const ServedLayer& after) {
  return table_of(before) != table_of(after);
}

}  // namespace

ChangeLog::ChangeLog(Options options) : options_(std::move(options)) {
  thread_ = std::thread([this] { work(); });
}

ChangeLog::~ChangeLog() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void ChangeLog::note(std::shared_ptr<const Dataset> before, std::shared_ptr<const Dataset> after) {
  if (before->generation() == after->generation()) return;
  auto step = std::make_shared<Step>();
  step->since = before->generation();
  step->generation = after->generation();
  step->before = std::move(before);
  step->after = std::move(after);
  {
    const std::lock_guard lock(mutex_);
    steps_.push_back(std::move(step));
    if (steps_.size() > kMostSteps) steps_.pop_front();
  }
  wake_.notify_all();
}

void ChangeLog::work() {
  while (true) {
    std::shared_ptr<Step> step;
    {
      std::unique_lock lock(mutex_);
      const auto next = [this] {
        return std::ranges::find_if(steps_, [](const auto& each) { return !each->is_compared; });
      };
      wake_.wait(lock, [&] { return is_stopping_ || next() != steps_.end(); });
      if (is_stopping_) return;
      step = *next();
    }
    std::vector<ChangedLayer> layers = compare(*step);
    {
      const std::lock_guard lock(mutex_);
      step->layers = layers;
      step->is_compared = true;
      step->before = nullptr;
      step->after = nullptr;
    }
    if (!options_.command.empty()) run_command(step->since, step->generation, layers);
  }
}

std::vector<ChangedLayer> ChangeLog::compare(const Step& step) const {
  std::set<std::string> names;
  for (const auto* dataset : {step.before.get(), step.after.get()}) {
    for (const ServedLayer& layer : dataset->layers()) names.insert(layer.config.name);
  }
  std::vector<ChangedLayer> layers;
  for (const std::string& name : names) {
    const auto before = step.before->find(name);
    const auto after = step.after->find(name);
    ChangedLayer layer;
    layer.name = name;
    layer.tiles.zooms = options_.zooms;
    if (before && after &&
        has_other_values(step.before->layers()[*before], step.after->layers()[*after])) {
      layer.is_everything = true;
    } else if (before && after) {
      if (step.before->layers()[*before].revision == step.after->layers()[*after].revision)
        continue;
      ChangeRequest request;
      request.tile.layers = {name};
      request.zooms = options_.zooms;
      request.certainty = Certainty::candidates;
      request.most_tiles = kMostTiles;
      try {
        auto found = changed_tiles(request, step.before, step.after);
        layer.is_everything = !found;
        if (found) layer.tiles = *std::move(found);
      } catch (const std::exception& error) {  // for lack of memory
        spdlog::error("what has changed of the layer {}: {}", name, failure_words(error));
        layer.is_everything = true;
      }
    } else {
      layer.is_everything = true;
    }
    spdlog::info("{}: {} from generation {} to {}", name,
                 layer.is_everything ? "everything may look different"
                                     : fmt::format("{} tiles of zooms {} to {} may look different",
                                                   layer.tiles.tiles.size(),
                                                   layer.tiles.zooms.first, layer.tiles.zooms.last),
                 step.since, step.generation);
    layers.push_back(std::move(layer));
  }
  return layers;
}

void ChangeLog::run_command(const std::string& since, const std::string& generation,
                            const std::vector<ChangedLayer>& layers) {
  const auto is_stopping = [this] {
    const std::lock_guard lock(mutex_);
    return is_stopping_;
  };
  try {
    const int status = trapeze::run_command(
        options_.command, {{"TRAPEZE_SINCE", since}, {"TRAPEZE_GENERATION", generation}},
        change_lines(layers), is_stopping);
    if (status != 0) spdlog::error("the command for changes ended with {}", status);
  } catch (const std::exception& error) {
    spdlog::error("the command for changes cannot be run: {}", failure_words(error));
  }
}

ChangeLog::Answer ChangeLog::between(std::string_view since, std::string_view generation) const {
  if (since == generation) return {Answer::State::known, {}};
  const std::lock_guard lock(mutex_);
  // The last time that the data was in that state, as it may come back to it.
  const auto first = std::find_if(steps_.rbegin(), steps_.rend(),
                                  [&](const auto& step) { return step->since == since; });
  if (first == steps_.rend()) return {};
  std::map<std::string, ChangedLayer> by_name;
  for (auto step = std::prev(first.base()); step != steps_.end(); ++step) {
    if (!(*step)->is_compared) return {Answer::State::pending, {}};
    for (const ChangedLayer& layer : (*step)->layers) {
      const auto [sum, is_new] = by_name.emplace(layer.name, layer);
      if (!is_new) add(layer, sum->second);
    }
    if ((*step)->generation != generation) continue;
    Answer answer{Answer::State::known, {}};
    for (auto& [name, layer] : by_name) answer.layers.push_back(std::move(layer));
    return answer;
  }
  return {Answer::State::pending, {}};  // it is served, and will be noted at once
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
