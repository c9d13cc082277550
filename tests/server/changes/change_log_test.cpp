#include "server/changes/change_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/core/io/temporary_folder.h"
#include "tests/server/service/sample_site.h"
#include "tests/server/tiles/edited_land.h"

namespace trapeze {
namespace {

using namespace std::chrono_literals;
using Generation = std::shared_ptr<const Dataset>;
using State = ChangeLog::Answer::State;

constexpr ZoomRange kLoggedZooms{0, 6};

bool holds_soon(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + 20s;
  while (std::chrono::steady_clock::now() < end) {
    if (condition()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

/// Another generation with the same polygons.
Generation with_revision(const Generation& dataset, std::uint64_t revision) {
  std::vector<ServedLayer> layers = dataset->layers_on_all_grids();
  layers[0].revision = revision;
  return std::make_shared<const Dataset>(std::move(layers));
}

Generation edited(testing::EditedLand& land, const Generation& before) {
  Generation after = before;
  while (after->generation() == before->generation()) {
    land.edit();
    after = land.load();
  }
  return after;
}

class ChangeLogTest : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.file(name); }
  bool is_there(const std::string& name) const { return std::filesystem::exists(path(name)); }

  ChangeLog::Answer ask(const ChangeLog& log, const Generation& since, const Generation& now) {
    ChangeLog::Answer answer;
    EXPECT_TRUE(holds_soon([&] {
      answer = log.between(since->generation(), now->generation());
      return answer.state != State::pending;
    }));
    return answer;
  }

  testing::EditedLand land_{17};
  const TemporaryFolder folder_;
};

TEST_F(ChangeLogTest, ASlowCommandIsToldOfEverythingThatChangesMeanwhile) {
  ChangeLog::Options options;
  options.zooms = kLoggedZooms;
  options.command =
      "touch " + path("began") + "; until [ -e " + path("go") +
      " ]; do sleep 0.01; done; { echo from $TRAPEZE_SINCE $TRAPEZE_GENERATION; cat; } >> " +
      path("said");
  ChangeLog log(options);
  std::vector<Generation> states{land_.load()};
  const auto come = [&](Generation next) {
    log.note(states.back(), next);
    states.push_back(std::move(next));
  };
  come(edited(land_, states.back()));
  ASSERT_TRUE(holds_soon([this] { return is_there("began"); }));
  // Only the first of the following changes is visible; there are many more than the log keeps.
  come(edited(land_, states.back()));
  const ChangeLog::Answer second = ask(log, states[1], states[2]);
  ASSERT_EQ(second.state, State::known) << "although the command is still busy";
  ASSERT_FALSE(second.layers.at(0).tiles.tiles.empty());
  for (std::uint64_t i = 0; i < 100; ++i) {
    come(with_revision(states[2], i));
    if (i % 3 == 0) ask(log, states[states.size() - 2], states.back());  // so that few wait
  }
  EXPECT_EQ(ask(log, states[states.size() - 20], states.back()).state, State::known);
  EXPECT_EQ(ask(log, states.front(), states.back()).state, State::unknown);
  std::ofstream(path("go")).close();

  std::string since = states.front()->generation();
  std::set<std::string> told;
  ASSERT_TRUE(holds_soon([&] {
    since = states.front()->generation();
    std::ifstream said(path("said"));
    for (std::string line; std::getline(said, line);) {
      std::istringstream words(line);
      std::string word, from, to;
      words >> word >> from >> to;
      if (word != "from") {
        told.insert(line);
        continue;
      }
      EXPECT_EQ(from, since) << "something is left out";
      since = to;
    }
    return since == states.back()->generation();
  })) << "told up to "
      << since;
  std::istringstream lines(change_lines(second.layers));
  for (std::string line; std::getline(lines, line);) EXPECT_TRUE(told.contains(line)) << line;
}

TEST_F(ChangeLogTest, CommandsAreEndedAndNoMoreAreStarted) {
  ChangeLog::Options options;
  options.zooms = kLoggedZooms;
  options.command = "echo >> " + path("began") + "; exec sleep 600";
  ChangeLog log(options);
  const Generation first = land_.load();
  const Generation second = edited(land_, first);
  log.note(first, second);
  ASSERT_TRUE(holds_soon([this] { return is_there("began"); }));
  log.note(second, first);
  log.end_command();
  EXPECT_EQ(std::filesystem::file_size(path("began")), 1u);
}

TEST_F(ChangeLogTest, CommandsAreEndedWithWhatTheyHaveStartedEvenIfThatIgnoresSigterm) {
  ChangeLog::Options options;
  options.zooms = kLoggedZooms;
  // The outer shell, which waits for the inner one, ends at SIGTERM.
  options.command = "sh -c 'trap \"\" TERM; for i in $(seq 500); do echo >> " + path("alive") +
                    "; sleep 0.02; done'; true";
  ChangeLog log(options);
  const Generation first = land_.load();
  log.note(first, edited(land_, first));
  ASSERT_TRUE(holds_soon([this] { return is_there("alive"); }));
  log.end_command();
  const auto size = std::filesystem::file_size(path("alive"));
  std::this_thread::sleep_for(200ms);
  EXPECT_EQ(std::filesystem::file_size(path("alive")), size);
}

TEST_F(ChangeLogTest, StatesOfLiveLayersAreAllCompared) {
  ChangeLog::Options options;
  options.zooms = kLoggedZooms;
  ChangeLog log(options);
  std::vector<Generation> states = {land_.load()};
  states.push_back(edited(land_, states[0]));
  for (std::uint64_t i = 0; i < 20; ++i) states.push_back(with_revision(states[1], i));
  for (std::size_t i = 1; i < states.size(); ++i) {
    log.note(states[i - 1], states[i], ChangeLog::Memory::shared);
  }
  for (std::size_t i = 1; i < states.size(); ++i) {
    const ChangeLog::Answer answer = ask(log, states[i - 1], states[i]);
    ASSERT_EQ(answer.state, State::known) << i;
    for (const ChangedLayer& layer : answer.layers) EXPECT_FALSE(layer.is_everything) << i;
  }
}

TEST_F(ChangeLogTest, FewStatesAreKeptWhileTheyWaitAndWhatOnlyTheyShowedIsTold) {
  ChangeLog::Options options;
  options.zooms = kLoggedZooms;
  options.command = "cat >> " + path("said") + "; echo $TRAPEZE_GENERATION >> " + path("said");
  ChangeLog log(options);
  const Generation first = land_.load();
  const Generation second = edited(land_, first);
  std::vector<ServedLayer> layers = second->layers_on_all_grids();
  layers[0].config.max_zoom = 4;
  const auto other = std::make_shared<const Dataset>(std::move(layers));
  log.note(first, second);
  log.note(second, other);
  log.note(other, second);
  std::vector<std::weak_ptr<const Dataset>> states;
  Generation last = second;
  for (std::uint64_t i = 0; i < 200; ++i) {
    Generation next = with_revision(second, i);
    log.note(last, next);
    states.push_back(next);
    last = std::move(next);
    EXPECT_LE(std::ranges::count_if(states, [](const auto& state) { return !state.expired(); }), 8);
  }
  std::string said;
  ASSERT_TRUE(holds_soon([&] {
    said = read_file(path("said"));
    return said.ends_with(last->generation() + "\n");
  }));
  EXPECT_NE(said.find(second->layers()[0].config.name + " 0/*\n"), std::string::npos);
}

TEST_F(ChangeLogTest, ALayerThatIsShownOtherwiseMayLookDifferentEverywhere) {
  ChangeLog::Options options;
  options.zooms = kLoggedZooms;
  ChangeLog log(options);
  const Generation first = land_.load();
  const auto note_with = [&](const std::function<void(LayerConfig&)>& change) {
    std::vector<ServedLayer> layers = first->layers_on_all_grids();
    change(layers[0].config);
    const auto next = std::make_shared<const Dataset>(std::move(layers));
    log.note(first, next);
    return next;
  };
  const auto is_everywhere = [&](const Generation& next) {
    const ChangeLog::Answer answer = ask(log, first, next);
    return answer.state == State::known && answer.layers.size() == 1 &&
           answer.layers[0].is_everything;
  };
  EXPECT_TRUE(is_everywhere(
      note_with([](LayerConfig& land) { land.style = testing::style_of("fill=teal"); })));
  EXPECT_TRUE(is_everywhere(note_with([](LayerConfig& land) { land.max_zoom = 4; })));
  EXPECT_TRUE(is_everywhere(note_with([](LayerConfig& land) { land.min_zoom = 2; })));
  EXPECT_EQ(note_with([](LayerConfig& land) { land.title = "Land"; })->generation(),
            first->generation());
}

TEST_F(ChangeLogTest, TheSumOfManyChangesListsNoMoreTilesThanOneDoes) {
  ChangeLog::Options options;
  options.zooms = {0, 9};
  options.most_tiles = 25;
  ChangeLog log(options);
  std::vector<Generation> states{land_.load()};
  for (int i = 0; i < 12; ++i) {
    states.push_back(edited(land_, states.back()));
    log.note(states[states.size() - 2], states.back());
  }
  const ChangeLog::Answer answer = ask(log, states.front(), states.back());
  ASSERT_EQ(answer.state, State::known);
  const ChangedLayer& layer = answer.layers.at(0);
  ASSERT_FALSE(layer.is_everything);
  EXPECT_FALSE(layer.tiles.is_complete);
  EXPECT_LT(layer.tiles.zooms.last, options.zooms.last);
  std::vector<std::size_t> tiles_of(static_cast<std::size_t>(options.zooms.last) + 1);
  for (const TileId& tile : layer.tiles.tiles) {
    EXPECT_LE(tile.z, layer.tiles.zooms.last);
    EXPECT_LE(++tiles_of[static_cast<std::size_t>(tile.z)], options.most_tiles);
  }
}

}  // namespace
}  // namespace trapeze
