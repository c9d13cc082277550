#include "bench/experiment/growth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "bench/core/polygon_families.h"
#include "bench/experiment/race.h"
#include "core/adapt/adaptable_graph.h"
#include "core/grid/tolerance.h"
#include "core/layer/layer_builder.h"
#include "core/sweep/graph_builder.h"
#include "render/mask/stopwatch.h"

namespace trapeze::experiment {
namespace {

constexpr std::size_t kFewest = 1000;
constexpr double kEnoughMs = 2000;  // a measurement of that length need not be repeated
constexpr int kRepetitions = 3;

/// `measure` makes one measurement and records it.
template <class Measure>
void repeat(const Measure& measure) {
  double spent_ms = 0;
  for (int i = 0; i < kRepetitions && spent_ms < kEnoughMs; ++i) {
    const Stopwatch stopwatch(spent_ms);
    measure();
  }
}

template <class Work>
void time(std::vector<double>& times, const Work& work) {
  double ms = 0;
  {
    const Stopwatch stopwatch(ms);
    work();
  }
  times.push_back(ms);
}

void time_graph(const Rings& rings, GrowthPoint& point) {
  std::vector<double> build, weigh, generalize, undo;
  repeat([&] {
    Rings copy = rings;
    TrapezoidalGraph graph;
    time(build, [&] { GraphBuilder().build(copy, graph); });
    std::optional<AdaptableGraph> adaptable;
    time(weigh, [&] { adaptable.emplace(std::move(graph)); });
    time(generalize, [&] { adaptable->adapt_to(std::numeric_limits<double>::max()); });
    point.graph_memory = adaptable->memory();
    time(undo, [&] { adaptable->adapt_to(0); });
  });
  point.build_ms = median(build);
  point.weigh_ms = median(weigh);
  point.generalize_ms = median(generalize);
  point.undo_ms = median(undo);
}

View view_of_all() {
  View view;
  view.width = kScreenWidth;
  view.height = kScreenHeight;
  view.cells_per_pixel = 2 * kFamilyReach / kScreenHeight;
  view.origin_x = -static_cast<std::int64_t>(view.cells_per_pixel * kScreenWidth / 2);
  view.origin_y = -static_cast<std::int64_t>(view.cells_per_pixel * kScreenHeight / 2);
  return view;
}

std::unique_ptr<Layer> build_layer(Rings rings) {
  std::vector<LayerBuilder> builders;
  builders.emplace_back();
  builders[0].add(0, rings);
  return LayerBuilder::join(builders, FeatureTable());
}

void measure_layer(const Rings& rings, Screen& screen, GrowthPoint& point) {
  std::vector<double> load, draw;
  std::unique_ptr<Layer> layer;
  repeat([&] {
    layer.reset();
    time(load, [&] { layer = build_layer(rings); });
  });
  point.load_ms = median(load);
  point.layer_memory = layer->memory();
  screen.send(layer->mesh());
  const View view = view_of_all();
  const Level level = nearest_level(view.cells_per_pixel / 4);
  std::vector<Ranges> ranges(1);
  std::vector<Mask> masks;
  const std::vector<MeshView> meshes{layer->mesh()};
  for (int i = 0; i < 2 * kRepetitions + 1; ++i) {
    time(draw, [&] {
      layer->select({view.box(), level, level, SmallPolygons::dust}, ranges[0]);
      layer->keep_uppermost(ranges[0]);
      screen.draw(meshes, ranges, view, masks);
    });
  }
  point.view_ms = median(draw);
  screen.forget(layer->mesh().id);
}

}  // namespace

std::vector<GrowthPoint> measure_growth(std::size_t most, Screen& screen) {
  std::vector<GrowthPoint> points;
  for (int half_powers = 0;; ++half_powers) {
    const auto vertices = static_cast<std::size_t>(
        std::lround(static_cast<double>(kFewest) * std::pow(10, half_powers / 2.0)));
    if (vertices > most) return points;
    GrowthPoint point;
    const Rings rings = wiggly_star(vertices);
    point.vertices = rings.points.size();
    time_graph(rings, point);
    measure_layer(rings, screen, point);
    points.push_back(point);
  }
}

}  // namespace trapeze::experiment
