#include "tests/experiment/sample_map.h"

#include "bench/core/polygon_families.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze::experiment {
namespace {

MapLayer layer_of(const std::string& title, std::vector<Rings> features) {
  MapLayer layer;
  layer.source.title = title;
  layer.features = std::move(features);
  for (const Rings& rings : layer.features) layer.polygons.add_feature(rings);
  layer.vertices = layer.polygons.rings.points.size();
  return layer;
}

/// Scaled down and moved beside the town.
Rings small_coast() {
  Rings coast = wiggly_star(2000);
  for (Point& p : coast.points) p = {p.x / 1000 - 400000, p.y / 1000 + 500000};
  return coast;
}

}  // namespace

std::vector<PolygonSet> random_polygon_sets(unsigned count) {
  std::vector<PolygonSet> sets(count);
  for (unsigned seed = 0; seed < count; ++seed) sets[seed].add_feature(random_shape(seed));
  return sets;
}

Map sample_map(unsigned buildings) {
  std::vector<Rings> town;
  for (unsigned i = 0; i < buildings; ++i) town.push_back(building(i + 1));
  Map map;
  map.source.name = "sample";
  map.layers.push_back(layer_of("coast", {small_coast()}));
  map.layers.push_back(layer_of("buildings", std::move(town)));
  for (const MapLayer& layer : map.layers) {
    for (const Point p : layer.polygons.rings.points) map.bounds.include(p);
  }
  return map;
}

}  // namespace trapeze::experiment
