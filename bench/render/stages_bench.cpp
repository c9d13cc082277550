// The cost of the stages of a tile on real maps: selection, drawing, colour, PNG.
//
//   TRAPEZE_DATA=folder stages_bench                     all, some minutes
//   stages_bench --benchmark_filter=draw/software        a part
//
// Names are STAGE/LAYER/zoom:Z. The layers represent typical contents of maps: many small polygons
// (buildings), medium ones with holes (land use), a coverage (countries), one giant. For each layer
// and zoom the same tiles, each of which contains a random vertex, are processed in turns; times
// are per tile.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/trip.h"
#include "core/grid/tolerance.h"
#include "core/io/load/load_layer.h"
#include "core/layer/layer.h"
#include "render/make_renderer.h"
#include "render/mask/mask.h"
#include "render/picture/compose.h"
#include "render/picture/png.h"

namespace trapeze {
namespace {

constexpr const char* kLayers[] = {"malta_buildings", "malta_landuse", "shenzhen_buildings",
                                   "europe_countries", "usa48_land"};
constexpr int kZooms[] = {2, 6, 10, 14, 18};
constexpr std::size_t kTiles = 16;
constexpr double kTolerance = 0.25;  // pixels, the default of requests
constexpr Rgba kFill{160, 80, 64, 255};

/// A layer and its places.
struct Subject {
  std::unique_ptr<Layer> layer;
  Places places;
};

/// Layers stay loaded from one benchmark to the next.
const Subject& subject_of(const std::string& name) {
  static std::map<std::string, Subject> subjects;
  Subject& subject = subjects[name];
  if (subject.layer == nullptr) {
    const std::vector<TripLayer> layers{{name, real_data_folder() + "/" + name + ".fgb", ""}};
    subject.layer = load_layer(layers.front().file).layer;
    subject.places = read_places(layers);
  }
  return subject;
}

/// One of the tiles, with the data passed between stages.
struct StagedTile {
  View view;
  Layer::Selection selection;
  std::vector<TrapezoidRange> ranges;
  Mask mask;
  RunPicture picture;
};

std::size_t count_of(std::span<const TrapezoidRange> ranges) {
  std::size_t count = 0;
  for (const TrapezoidRange& range : ranges) count += range.count;
  return count;
}

std::vector<StagedTile> selected_tiles(const Subject& subject, int zoom) {
  std::vector<StagedTile> tiles;
  for (const TileId& id : tiles_at_vertices(subject.places, zoom, zoom, kTiles)) {
    StagedTile tile;
    tile.view = View::of_tile(id);
    const Level level = nearest_level(kTolerance * tile.view.cells_per_pixel);
    tile.selection = {tile.view.box(), level, level, SmallPolygons::dust};
    subject.layer->select(tile.selection, tile.ranges);
    subject.layer->keep_uppermost(tile.ranges);
    tiles.push_back(std::move(tile));
  }
  return tiles;
}

void draw_all(const Subject& subject, MaskRenderer& renderer, std::vector<StagedTile>& tiles) {
  for (StagedTile& tile : tiles) {
    renderer.draw(subject.layer->mesh(), tile.ranges, tile.view, tile.mask);
  }
}

void compose_one(Composer& composer, StagedTile& tile) {
  const PaintedClass filled{&tile.mask, kFill};
  PaintedLayer layer;
  layer.classes = {&filled, 1};
  composer.compose({&layer, 1}, tile.view.width, tile.view.height, kTransparent, Quality::bounded,
                   tile.picture);
}

/// Runs the step for one tile after the other.
template <typename Step>
void go_round(benchmark::State& state, std::vector<StagedTile>& tiles, const Step& step) {
  std::size_t next = 0;
  for (auto _ : state) {
    step(tiles[next]);
    next = (next + 1) % tiles.size();
  }
  std::size_t trapezoids = 0;
  for (const StagedTile& tile : tiles) trapezoids += count_of(tile.ranges);
  state.counters["trapezoids"] =
      static_cast<double>(trapezoids) / static_cast<double>(tiles.size());
}

void select(benchmark::State& state, const std::string& layer) {
  const Subject& subject = subject_of(layer);
  auto tiles = selected_tiles(subject, static_cast<int>(state.range(0)));
  std::vector<TrapezoidRange> ranges;
  go_round(state, tiles, [&](StagedTile& tile) {
    subject.layer->select(tile.selection, ranges);
    benchmark::DoNotOptimize(ranges.data());
  });
}

void draw(benchmark::State& state, const std::string& layer, RendererKind kind) {
  const Subject& subject = subject_of(layer);
  auto tiles = selected_tiles(subject, static_cast<int>(state.range(0)));
  std::unique_ptr<MaskRenderer> renderer;
  try {
    renderer = make_renderer({kind, {}}).renderer;
  } catch (const std::exception& error) {
    return state.SkipWithError(error.what());
  }
  draw_all(subject, *renderer, tiles);  // uploads
  go_round(state, tiles, [&](StagedTile& tile) {
    renderer->draw(subject.layer->mesh(), tile.ranges, tile.view, tile.mask);
    benchmark::DoNotOptimize(tile.mask.row(0).data());
  });
}

std::vector<StagedTile> drawn_tiles(const Subject& subject, int zoom) {
  auto tiles = selected_tiles(subject, zoom);
  draw_all(subject, *make_renderer({RendererKind::software, {}}).renderer, tiles);
  return tiles;
}

void resolve(benchmark::State& state, const std::string& layer) {
  auto tiles = drawn_tiles(subject_of(layer), static_cast<int>(state.range(0)));
  Composer composer;
  go_round(state, tiles, [&](StagedTile& tile) {
    compose_one(composer, tile);
    benchmark::DoNotOptimize(tile.picture.runs.data());
  });
}

void encode(benchmark::State& state, const std::string& layer) {
  auto tiles = drawn_tiles(subject_of(layer), static_cast<int>(state.range(0)));
  Composer composer;
  for (StagedTile& tile : tiles) compose_one(composer, tile);
  PngEncoder encoder;
  std::size_t bytes = 0;
  go_round(state, tiles, [&](StagedTile& tile) {
    const std::string png = encoder.encode(tile.picture);
    bytes += png.size();
    benchmark::DoNotOptimize(png.data());
  });
  state.counters["bytes"] =
      benchmark::Counter(static_cast<double>(bytes), benchmark::Counter::kAvgIterations);
}

double smallest(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

template <typename Run>
void add(const std::string& stage, const std::string& layer, const Run& run) {
  auto* bench = benchmark::RegisterBenchmark((stage + "/" + layer).c_str(), run);
  for (const int zoom : kZooms) bench->Arg(zoom);
  bench->ArgName("zoom")
      ->Unit(benchmark::kMicrosecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime()
      ->MinTime(0.05)
      ->Repetitions(3)
      ->ComputeStatistics("min", smallest)
      ->DisplayAggregatesOnly();
}

void add_stages(const std::string& layer) {
  using benchmark::State;
  add("select", layer, [layer](State& state) { select(state, layer); });
  add("draw/software", layer,
      [layer](State& state) { draw(state, layer, RendererKind::software); });
  add("draw/egl", layer, [layer](State& state) { draw(state, layer, RendererKind::egl); });
  add("resolve", layer, [layer](State& state) { resolve(state, layer); });
  add("encode", layer, [layer](State& state) { encode(state, layer); });
}

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  try {
    trapeze::real_data_folder();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stages_bench: %s\n", error.what());
    return 1;
  }
  for (const char* layer : trapeze::kLayers) trapeze::add_stages(layer);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
