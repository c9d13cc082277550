// What styles cost: a tile drawn in each, against the same tile in the layer's own; and the way
// from a URL to the key under which its tile is cached, the style written out or named.
//
//   TRAPEZE_DATA=folder style_bench
//
// Tiles are of Malta's land use and buildings, zooms 10 to 17, each of another zoom than the one
// before, painted by the software renderer; times are those of one tile. Compare rows of one run.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/trip.h"
#include "server/tiles/tile_painter.h"
#include "server/tiles/tile_request.h"

namespace trapeze {
namespace {

constexpr std::size_t kTilesPerZoom = 8;

struct Style {
  const char* name;
  const char* query;
};
constexpr Style kStyles[] = {
    {"plain", ""},
    {"one_class", "color-by=type&classes=*:red"},
    {"three_classes", "color-by=type&classes=residential:red,farmland:green,*:blue"},
    {"filter", "filter=type='residential'"},
    {"outline", "stroke=black"},
    {"outline_dashed", "stroke=black&stroke-dasharray=4,2"},
    {"hatch", "pattern=hatch"},
    {"dots", "pattern=dots"},
    {"opacity", "opacity=0.5"},
    // Without making colours fewer, which takes most of a tile of many edges.
    {"plain_exact", "quality=exact"},
    {"three_classes_exact",
     "color-by=type&classes=residential:red,farmland:green,*:blue&quality=exact"},
    {"outline_exact", "stroke=black&quality=exact"},
    {"outline_dashed_exact", "stroke=black&stroke-dasharray=4,2&quality=exact"},
    {"hatch_exact", "pattern=hatch&quality=exact"},
};

std::vector<TripLayer> trip_layers() {
  std::vector<TripLayer> layers;
  for (const std::string name : {"landuse", "buildings"}) {
    layers.push_back({name, real_data_folder() + "/malta_" + name + ".fgb", ""});
  }
  return layers;
}

std::shared_ptr<const Dataset> dataset() {
  static const auto loaded = [] {
    std::vector<LayerConfig> layers;
    for (const TripLayer& layer : trip_layers()) {
      LayerConfig config;
      config.name = layer.name;
      config.title = layer.name;
      config.file = layer.file;
      layers.push_back(config);
    }
    return Dataset::load(layers);
  }();
  return loaded;
}

const std::vector<TileId>& tiles() {
  static const auto chosen = [] {
    const Places places = read_places(trip_layers());
    std::vector<std::vector<TileId>> by_zoom;
    for (int zoom = 10; zoom <= 17; ++zoom) {
      by_zoom.push_back(tiles_at_vertices(places, zoom, zoom, kTilesPerZoom));
    }
    std::vector<TileId> all;
    for (std::size_t i = 0; i < kTilesPerZoom; ++i) {
      for (const auto& some : by_zoom) {
        if (i < some.size()) all.push_back(some[i]);
      }
    }
    return all;
  }();
  return chosen;
}

std::string target_of(const TileId& tile, const std::string& query) {
  return "/tiles/landuse,buildings/" + std::to_string(tile.z) + "/" + std::to_string(tile.x) + "/" +
         std::to_string(tile.y) + ".png?" + query;
}

const StyleBook& styles() {
  static const auto book = [] {
    std::map<std::string, StyleQuery> named;
    for (const Style& style : kStyles) {
      named.emplace(style.name, *StyleQuery::parse(decode_query(style.query).value(), {}));
    }
    return std::make_unique<StyleBook>(std::move(named));
  }();
  return *book;
}

TilePlan plan_of(const std::string& target) {
  auto parsed = parse_tiles_target(split_target(target).value(), styles());
  return *plan_tile(std::get<TileRequest>(*parsed), dataset());
}

void paint(benchmark::State& state, const std::string& query) {
  std::vector<TilePlan> plans;
  for (const TileId& tile : tiles()) plans.push_back(plan_of(target_of(tile, query)));
  TilePainter painter(make_renderer({RendererKind::software, {}}).renderer);
  // All of them, however slow the style is: they differ by more than styles do.
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(plans.size()))) {
    for (const TilePlan& plan : plans) {
      const TilePainter::Job job{&plan};
      benchmark::DoNotOptimize(painter.paint({&job, 1}));
    }
  }
}

void make_key(benchmark::State& state, const std::string& query) {
  const std::string target = target_of(tiles().front(), query);
  for (auto _ : state) benchmark::DoNotOptimize(plan_of(target).key());
}

void register_all() {
  for (const Style& style : kStyles) {
    const std::string name = style.name;
    benchmark::RegisterBenchmark(("paint/" + name).c_str(), paint, style.query)
        ->Unit(benchmark::kMicrosecond);
  }
  for (const Style& style : kStyles) {
    const std::string name = style.name;
    benchmark::RegisterBenchmark(("key/" + name).c_str(), make_key, style.query)
        ->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark(("key_by_name/" + name).c_str(), make_key, "style=" + name)
        ->Unit(benchmark::kMicrosecond);
  }
}

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  try {
    trapeze::register_all();
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "style_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
