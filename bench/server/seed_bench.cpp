// The cost of seeding in addition to drawing: the tiles of a layer as `trapeze seed` makes them,
// compared with drawing the same drawn tiles again with the same number of threads and nothing
// else, in turns.
//
//   seed_bench [--layer FILE] [--zooms A-B] [--rounds N]
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/measure/figures.h"
#include "bench/measure/run_program.h"
#include "bench/measure/trip.h"
#include "bench/server/trapeze_server.h"
#include "core/grid/for_each_in_parallel.h"
#include "server/base/zoom_range.h"
#include "server/config/load_config.h"
#include "server/seed/seeder.h"
#include "server/tiles/start_renderers.h"

namespace trapeze {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::string layer;  // empty: land use of Melbourne
  std::string zooms = "10-17";
  std::string renderer = "software";
  int rounds = 3;
  std::string json = "out/bench/seed.json";
};

/// Time that has passed, and time that processors have worked for this process.
struct Cost {
  double seconds = 0;
  double processor_seconds = 0;
};

class Stopwatch {
 public:
  Cost read() const {
    return {std::chrono::duration<double>(Clock::now() - begin_).count(),
            static_cast<double>(std::clock() - processor_begin_) / CLOCKS_PER_SEC};
  }

 private:
  Clock::time_point begin_ = Clock::now();
  std::clock_t processor_begin_ = std::clock();
};

/// Draws with as many threads as there are cores.
class Seeding {
 public:
  Seeding(const Options& options, const std::string& layer)
      : dataset_(Dataset::load(layers_of_files({layer}))) {
    const auto kind = kRendererNames.find(options.renderer);
    if (!kind) throw std::runtime_error("there is no renderer " + options.renderer);
    renderer_.kind = *kind;
    SeedRequest request;
    request.tile.layers = {dataset_->layers().front().config.name};
    const auto zooms = parse_zooms(options.zooms);
    if (!zooms) throw std::runtime_error("--zooms takes a range such as 10-17");
    request.zooms = *zooms;
    request.bbox = summarize_layers(request.tile.layers, *dataset_)->bounds();
    plan_ = *SeedPlan::make(request, dataset_);
    KnownTiles known(*plan_, TilePainter::new_class_cache(), std::make_shared<LabelBook>());
    jobs_ = divide_into_jobs(*plan_, known);
  }

  struct Run {
    Cost cost;
    SeedFigures figures;
  };

  /// As `trapeze seed`, up to the archive; `drawn` receives the tiles that were drawn.
  Run seed(std::vector<TileId>& drawn) const {
    const ScratchFolder folder;
    const std::string path = folder.path() + "/log";
    const JobRange all{0, jobs_.jobs.size()};
    Seeder seeder(*plan_, jobs_, renderers(), std::make_shared<LabelBook>(), {});
    Run run;
    {
      SeedLog log(path, {plan_->identity("bench", ""), jobs_.jobs.size(), all, {}, {}});
      const Stopwatch watch;
      seeder.seed(all, log, [](const SeedProgress&) {});
      run.cost = watch.read();
    }
    const SeedLogs logs({path});
    run.figures = logs.figures();
    drawn.clear();
    for (const SeedBlock& block : logs.blocks()) add_drawn(block, drawn);
    return run;
  }

  /// Draws the tiles only, one after the other on each thread.
  Cost draw(const std::vector<TileId>& tiles) const {
    constexpr std::size_t kAtOnce = 64;
    const auto classes = TilePainter::new_class_cache();
    std::vector<TilePainter> painters;
    for (auto& renderer : renderers()) painters.emplace_back(std::move(renderer), classes);
    std::atomic<std::size_t> next{0};
    const Stopwatch watch;
    for_each_in_parallel(painters.size(), painters.size(), [&](std::size_t thread) {
      for (std::size_t i = next.fetch_add(kAtOnce); i < tiles.size(); i = next.fetch_add(kAtOnce)) {
        for (std::size_t j = i; j < std::min(i + kAtOnce, tiles.size()); ++j) {
          const TilePlan plan = plan_->plan_of(tiles[j]);
          const PaintJob job{&plan};
          if (!painters[thread].paint({&job, 1}).front()) throw std::runtime_error("not drawn");
        }
      }
    });
    return watch.read();
  }

 private:
  std::vector<std::unique_ptr<MaskRenderer>> renderers() const {
    return start_renderers(renderer_, renderer_count(0));
  }

  // Contents with a fingerprint were drawn; those determined for many tiles together have none.
  void add_drawn(const SeedBlock& block, std::vector<TileId>& drawn) const {
    std::set<std::uint64_t> contents;
    for (const BlockFingerprint& each : block.fingerprints()) contents.insert(each.content);
    for (int zoom = plan_->zooms().first; zoom <= plan_->zooms().last; ++zoom) {
      for (const BlockEntry& entry : block.entries(zoom)) {
        if (entry.places.count != 1 || !contents.contains(entry.content)) continue;
        drawn.push_back(tile_at_place(zoom, entry.places.first));
      }
    }
  }

  RendererOptions renderer_;
  std::shared_ptr<const Dataset> dataset_;
  std::optional<SeedPlan> plan_;
  SeedJobs jobs_;
};

int run(int argc, char** argv) {
  Options options;
  CLI::App app("What seeding costs beside drawing the same tiles");
  app.add_option("--layer", options.layer, "A file; land use of Melbourne if not set");
  app.add_option("--zooms", options.zooms)->capture_default_str();
  app.add_option("--renderer", options.renderer)->capture_default_str();
  app.add_option("--rounds", options.rounds)->check(CLI::Range(1, 99))->capture_default_str();
  app.add_option("--json", options.json, "Where the figures go")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const std::string layer =
      options.layer.empty() ? real_data_folder() + "/melbourne_landuse.fgb" : options.layer;
  const Seeding seeding(options, layer);
  std::vector<double> ratios;
  std::vector<double> processor_ratios;
  std::vector<double> rates;
  std::vector<TileId> drawn;
  for (int round = 0; round < options.rounds; ++round) {
    const Seeding::Run run = seeding.seed(drawn);
    const Cost alone = seeding.draw(drawn);
    const auto count = static_cast<double>(drawn.size());
    rates.push_back(count / run.cost.seconds);
    ratios.push_back(alone.seconds / run.cost.seconds);
    processor_ratios.push_back(alone.processor_seconds / run.cost.processor_seconds);
    std::printf(
        "%s: %.0f tiles, %zu drawn: seeded in %.2f s, %.0f a second; drawn alone in "
        "%.2f s, %.0f a second; %.3f, by processor time %.3f\n",
        std::filesystem::path(layer).stem().c_str(), static_cast<double>(run.figures.tiles()),
        drawn.size(), run.cost.seconds, rates.back(), alone.seconds, count / alone.seconds,
        ratios.back(), processor_ratios.back());
  }
  Figure figure("seed/" + std::filesystem::path(layer).stem().string());
  figure.set("tiles drawn a second", percentiles_of(rates).p50);
  figure.set("of what drawing alone does", percentiles_of(ratios).p50);
  figure.set("of what drawing alone does, by processor time", percentiles_of(processor_ratios).p50);
  write_figures({figure}, command_line(argc, argv), options.json);
  return 0;
}

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  return trapeze::run_program("seed_bench", trapeze::run, argc, argv);
}
