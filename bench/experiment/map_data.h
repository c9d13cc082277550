// The maps of the experiment: layers of polygons, the same for all contestants.
//
// All sources are processed in the same way: rings are snapped to the grid, cleaned and noded as
// for a layer that is served, and split into single polygons with their holes. So no contestant
// starts with geometry that another one would have to repair.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "core/grid/grid.h"
#include "core/grid/rings.h"
#include "core/layer/layer.h"

namespace trapeze::experiment {

/// Consecutive polygons, each a shell and its holes. Every ring begins at its topmost vertex.
struct PolygonSet {
  Rings rings;
  std::vector<std::uint32_t> ends;            // polygon i is rings ends[i - 1] .. ends[i] - 1
  std::vector<Box> boxes;                     // by polygon
  std::vector<std::uint32_t> second_anchors;  // by ring: the vertex farthest from its first one

  std::size_t size() const { return ends.size(); }
  std::uint32_t first_ring(std::size_t polygon) const {
    return polygon == 0 ? 0 : ends[polygon - 1];
  }
  std::size_t memory() const;
  /// Appends the polygons formed by the rings of a feature.
  void add_feature(Rings rings);
};

/// The vertex of a ring that is farthest from its first one; the uppermost in case of a tie.
std::uint32_t second_anchor_of(std::span<const Point> ring);

/// A file and the position of its polygons.
struct LayerSource {
  std::string file;
  std::string title;
  std::string origin;  // the origin of the data
  /// Name of the layer below whose box this one is moved, without changing its scale; empty: it is
  /// not moved.
  std::string below;
};

struct MapLayer {
  LayerSource source;
  std::vector<Rings> features;  // on the grid
  PolygonSet polygons;
  std::size_t vertices = 0;
};

/// Scales apply to the centre of the map: 1 : `largest_scale` is the closest view.
struct MapSource {
  std::string name;
  std::string title;
  std::string licence;
  std::vector<LayerSource> layers;
  double smallest_scale = 250000;
  double largest_scale = 3000;
};

struct Map {
  MapSource source;
  std::vector<MapLayer> layers;
  Box bounds;

  std::size_t polygon_count() const;
  std::size_t vertex_count() const;
};

/// Throws std::runtime_error if a file cannot be read or contains no polygons.
Map load_map(const MapSource& source);

/// The layer that contestants with lifespans draw from; rows are features.
std::unique_ptr<Layer> build_layer(const MapLayer& layer, Topology topology);

/// The maps of the page whose files exist: `data` is the folder of real layers and may be empty,
/// `sample` that of the sample world.
std::vector<MapSource> known_maps(const std::string& data, const std::string& sample);

}  // namespace trapeze::experiment
