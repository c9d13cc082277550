#include "bench/experiment/map_data.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "bench/core/source_rings.h"
#include "core/borders/polygons.h"
#include "core/layer/layer_builder.h"
#include "core/sweep/graph_builder.h"

namespace trapeze::experiment {
namespace {

constexpr const char* kOpenStreetMap = "(c) OpenStreetMap contributors, ODbL 1.0";

Box box_of(std::span<const Point> points) {
  Box box;
  for (const Point p : points) box.include(p);
  return box;
}

Box box_of(const std::vector<Rings>& features) {
  Box box;
  for (const Rings& rings : features) box.include(box_of(rings.points));
  return box;
}

/// Moves the features so that their box is below `upper`, horizontally centred on it.
void move_below(const Box& upper, std::vector<Rings>& features) {
  const Box box = box_of(features);
  const std::int64_t middle = (std::int64_t{upper.min_x} + upper.max_x) / 2;
  const std::int64_t dx = middle - (std::int64_t{box.min_x} + box.max_x) / 2;
  const std::int64_t dy = std::int64_t{upper.max_y} - box.min_y;
  for (Rings& rings : features) {
    for (Point& p : rings.points) {
      p = {static_cast<std::int32_t>(p.x + dx), static_cast<std::int32_t>(p.y + dy)};
    }
  }
}

MapLayer load_layer_of(const LayerSource& source) {
  MapLayer layer;
  layer.source = source;
  layer.features = read_source_rings(source.file);
  if (layer.features.empty()) throw std::runtime_error(source.file + " holds no polygons");
  return layer;
}

/// Layers to be moved below the same one are moved together.
void place_layers(std::vector<MapLayer>& layers) {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const std::string& below = layers[i].source.below;
    if (below.empty()) continue;
    const auto upper = std::find_if(layers.begin(), layers.end(), [&](const MapLayer& other) {
      return other.source.title == below;
    });
    if (upper == layers.end()) throw std::runtime_error("there is no layer " + below);
    move_below(box_of(upper->features), layers[i].features);
  }
}

std::vector<MapSource> maps_of_data(const std::string& data) {
  const auto file = [&data](const std::string& name) {
    return (std::filesystem::path(data) / (name + ".fgb")).string();
  };
  const std::string shenzhen = "Shenzhen and northern Hong Kong, 2026";
  const std::string melbourne = "Melbourne, BBBike extract of December 2019";
  const std::string malta = "Malta, Geofabrik extract of 27 August 2018";
  return {
      {"shenzhen",
       "Shenzhen's buildings, with Melbourne's natural and land-use areas moved below them",
       kOpenStreetMap,
       {{file("melbourne_landuse"), "land use", melbourne, "buildings"},
        {file("melbourne_natural"), "natural areas", melbourne, "buildings"},
        {file("shenzhen_buildings"), "buildings", shenzhen, ""}}},
      {"malta",
       "Malta: land use, natural areas and buildings",
       kOpenStreetMap,
       {{file("malta_landuse"), "land use", malta, ""},
        {file("malta_natural"), "natural areas", malta, ""},
        {file("malta_buildings"), "buildings", malta, ""}}},
  };
}

MapSource sample_world(const std::string& sample) {
  const auto file = [&sample](const std::string& name) {
    return (std::filesystem::path(sample) / (name + ".fgb")).string();
  };
  const std::string packages = "geo-maps 0.6.0 by Simone Primarosa, December 2017";
  MapSource world{
      "world",
      "The sample world: countries, and bodies of water",
      kOpenStreetMap,
      {{file("countries"), "countries", packages, ""}, {file("water"), "water", packages, ""}}};
  // The outlines are accurate to about a kilometre.
  world.smallest_scale *= 400;
  world.largest_scale *= 400;
  return world;
}

bool is_there(const MapSource& map) {
  return std::all_of(map.layers.begin(), map.layers.end(),
                     [](const LayerSource& layer) { return std::filesystem::exists(layer.file); });
}

}  // namespace

std::size_t PolygonSet::memory() const {
  return rings.points.capacity() * sizeof(Point) + boxes.capacity() * sizeof(Box) +
         (rings.ends.capacity() + ends.capacity() + second_anchors.capacity()) *
             sizeof(std::uint32_t);
}

void PolygonSet::add_feature(Rings feature) {
  GraphBuilder builder;
  TrapezoidalGraph graph;
  if (!builder.build(feature, graph).built) return;
  const Polygons polygons = polygons_of(graph);
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    const std::size_t first = polygons.first_ring(p);
    for (std::size_t r = first; r < polygons.ends[p]; ++r) {
      rings.add(polygons.rings[r]);
      second_anchors.push_back(second_anchor_of(polygons.rings[r]));
    }
    ends.push_back(static_cast<std::uint32_t>(rings.size()));
    boxes.push_back(box_of(polygons.rings[first]));
  }
}

std::uint32_t second_anchor_of(std::span<const Point> ring) {
  const auto squared_distance = [&](Point p) {
    const double dx = static_cast<double>(p.x) - ring[0].x;
    const double dy = static_cast<double>(p.y) - ring[0].y;
    return dx * dx + dy * dy;
  };
  std::size_t second = 0;
  double farthest = 0;
  for (std::size_t i = 1; i < ring.size(); ++i) {
    const double distance = squared_distance(ring[i]);
    if (distance > farthest || (distance == farthest && is_above(ring[i], ring[second]))) {
      farthest = distance;
      second = i;
    }
  }
  return static_cast<std::uint32_t>(second);
}

std::size_t Map::polygon_count() const {
  std::size_t count = 0;
  for (const MapLayer& layer : layers) count += layer.polygons.size();
  return count;
}

std::size_t Map::vertex_count() const {
  std::size_t count = 0;
  for (const MapLayer& layer : layers) count += layer.vertices;
  return count;
}

Map load_map(const MapSource& source) {
  Map map;
  map.source = source;
  for (const LayerSource& layer : source.layers) map.layers.push_back(load_layer_of(layer));
  place_layers(map.layers);
  for (MapLayer& layer : map.layers) {
    for (const Rings& rings : layer.features) layer.polygons.add_feature(rings);
    layer.vertices = layer.polygons.rings.points.size();
    map.bounds.include(box_of(layer.polygons.rings.points));
  }
  return map;
}

std::unique_ptr<Layer> build_layer(const MapLayer& layer, Topology topology) {
  std::vector<LayerBuilder> builders;
  builders.emplace_back(LayerOptions{{.topology = topology}});
  Rings rings;
  for (std::size_t row = 0; row < layer.features.size(); ++row) {
    rings = layer.features[row];
    builders[0].add(static_cast<std::uint32_t>(row), rings);
  }
  return LayerBuilder::join(builders, FeatureTable());
}

std::vector<MapSource> known_maps(const std::string& data, const std::string& sample) {
  std::vector<MapSource> maps;
  if (!data.empty()) maps = maps_of_data(data);
  maps.push_back(sample_world(sample));
  std::erase_if(maps, [](const MapSource& map) { return !is_there(map); });
  return maps;
}

}  // namespace trapeze::experiment
