// The cost of styles: a tile drawn in each style, compared with the same tile in the layer's own;
// and the steps from a URL to the cache key of its tile, with the style written out or named. Also
// the cost of a posted table of 100,000 rows: reading it, joining it to as many features, and
// dividing its numbers into classes. And the cost of labels: placing 100,000 of them, and
// everything that the first tile of a labelled layer waits for.
//
//   TRAPEZE_DATA=folder style_bench
//
// Tiles are of Malta's land use and buildings, zooms 10 to 17, each at another zoom than the one
// before, painted by the software renderer; times are per tile. Compare rows of one run.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/trip.h"
#include "core/labels/label_placement.h"
#include "core/layer/layer_builder.h"
#include "server/tiles/open_fonts.h"
#include "server/tiles/tile_painter.h"
#include "server/tiles/tile_request.h"
#include "server/values/class_breaks.h"
#include "server/values/joined_values.h"
#include "server/values/read_values.h"

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
    // The same picture, from numbers of a joined table.
    {"three_classes_joined", "values=types&join=type&color-by=value&classes=1:red,2:green,*:blue"},
    {"filter", "filter=type='residential'"},
    {"outline", "stroke=black"},
    {"outline_dashed", "stroke=black&stroke-dasharray=4,2"},
    {"hatch", "pattern=hatch"},
    {"dots", "pattern=dots"},
    {"opacity", "opacity=0.5"},
    {"smooth", "smooth=8"},
    {"smooth_outline", "smooth=8&stroke=black"},
    {"grow", "grow=2"},
    {"grow_8", "grow=8"},
    {"grow_outline", "grow=2&stroke=black"},
    {"labels", "label=type"},
    {"labels_and_outline", "label=type&stroke=black"},
    // Without reducing colours, which takes most of the time for a tile with many edges.
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

std::shared_ptr<const ValueTable> read_table(const std::string& text) {
  auto table = read_values(text, TableFormat::csv, {});
  if (!table) throw std::runtime_error(table.problem().detail);
  return std::make_shared<const ValueTable>(*std::move(table));
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
    const NamedTables tables = {
        {"types", {read_table("key,value\nresidential,1\nfarmland,2\n"), "", ""}}};
    return Dataset::load(layers, nullptr, nullptr, std::make_shared<const NamedTables>(tables));
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

std::shared_ptr<LabelBook> label_book() {
  static const auto book = std::make_shared<LabelBook>(FontChoice{open_fonts({})});
  return book;
}

void paint(benchmark::State& state, const std::string& query) {
  std::vector<TilePlan> plans;
  for (const TileId& tile : tiles()) plans.push_back(plan_of(target_of(tile, query)));
  TilePainter painter(make_renderer({RendererKind::software, {}}).renderer,
                      TilePainter::new_class_cache(), open_fonts({}), label_book());
  // Always all tiles, however slow the style is: tiles differ more than styles do.
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(plans.size()))) {
    for (const TilePlan& plan : plans) {
      const PaintJob job{&plan};
      benchmark::DoNotOptimize(painter.paint({&job, 1}));
    }
  }
}

void make_key(benchmark::State& state, const std::string& query) {
  const std::string target = target_of(tiles().front(), query);
  for (auto _ : state) benchmark::DoNotOptimize(plan_of(target).key());
}

constexpr int kRows = 100'000;

std::string code_of(int row) {
  return "code-" + std::to_string(10'000'000 + row);
}

std::string large_table() {
  std::string text = "code,value\n";
  for (int row = 0; row < kRows; ++row)
    text += code_of(row) + "," + std::to_string(row * 0.37) + "\n";
  return text;
}

/// As many features as rows, in another order.
std::unique_ptr<const Layer> large_layer() {
  FeatureTable features({{"code", FieldType::text}});
  for (int row = 0; row < kRows; ++row) {
    const std::string code = code_of(static_cast<int>(std::int64_t{row} * 7919 % kRows));
    const Value value = std::string_view(code);
    features.append(row, {&value, 1});
  }
  std::vector<LayerBuilder> builders(1);
  return LayerBuilder::join(builders, std::move(features));
}

void read_rows(benchmark::State& state) {
  const std::string text = large_table();
  for (auto _ : state) benchmark::DoNotOptimize(read_table(text));
}

void join_rows(benchmark::State& state) {
  const auto table = read_table(large_table());
  const auto layer = large_layer();
  for (auto _ : state) benchmark::DoNotOptimize(JoinedValues::join(table, *layer, 0));
}

void part_rows(benchmark::State& state, const std::string& rule) {
  const auto layer = large_layer();
  const auto joined = *JoinedValues::join(read_table(large_table()), *layer, 0);
  for (auto _ : state) {
    benchmark::DoNotOptimize(class_breaks(*parse_break_rule(rule), joined->spread()));
  }
}

/// As many as would be visible on the parcels of a city.
std::vector<LabelCandidate> many_labels() {
  constexpr int kSide = 316;
  std::mt19937 random(1);
  std::vector<LabelCandidate> labels;
  for (int i = 0; i < kSide * kSide; ++i) {
    const double size = 500 + static_cast<double>(random() % 4'000);  // cells: 10 to 80 m
    labels.push_back({static_cast<double>(i % kSide) * 2'500,
                      static_cast<double>(i) / kSide * 2'500,
                      10.0F + static_cast<float>(random() % 30), 9, 16 / size});
  }
  return labels;
}

void place_labels(benchmark::State& state) {
  const std::vector<LabelCandidate> labels = many_labels();
  for (auto _ : state) {
    benchmark::DoNotOptimize(LabelPlacement(labels, static_cast<double>(kGridSize)));
  }
}

/// Anchors, texts and their widths, and the placement.
void place_first(benchmark::State& state) {
  const TilePlan plan = plan_of(target_of(tiles().front(), "label=type"));
  const FontChoice fonts{open_fonts({})};
  std::size_t features = 0;
  for (const ServedLayer& layer : dataset()->layers()) features += layer.layer->features().size();
  state.counters["features"] = static_cast<double>(features);
  for (auto _ : state) {
    LabelBook book(fonts);
    benchmark::DoNotOptimize(book.find({*plan.dataset, plan.labels, plan.view, plan.scale}));
  }
}

void register_all() {
  using benchmark::kMillisecond;
  benchmark::RegisterBenchmark("values/read_100000", read_rows)->Unit(kMillisecond);
  benchmark::RegisterBenchmark("values/join_100000", join_rows)->Unit(kMillisecond);
  for (const char* rule : {"quantile:5", "jenks:5"}) {
    benchmark::RegisterBenchmark((std::string("values/part_100000/") + rule).c_str(), part_rows,
                                 rule)
        ->Unit(kMillisecond);
  }
  benchmark::RegisterBenchmark("labels/place_100000", place_labels)->Unit(kMillisecond);
  benchmark::RegisterBenchmark("labels/first_tile", place_first)->Unit(kMillisecond);
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
