// The stored arrays of a layer; private to Layer and LayerBuilder.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adaptable_graph.h"
#include "core/layer.h"
#include "core/mesh_index.h"

namespace trapeze {

struct Layer::Contents {
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<MeshTrapezoid> trapezoids;
  std::vector<Lifespan> lifespans;        // by trapezoid
  std::vector<std::uint32_t> feature_of;  // by trapezoid, those of dust left out
  MeshView view;                          // looks at the arrays above
  // Trapezoids of polygons come first, then those of single motes, then those of merged ones.
  MeshIndex polygon_index;
  MeshIndex mote_index;
  MeshIndex merged_mote_index;
  Size size;
  GeneralizationOptions options;
  Rings outlines;                           // of all features, in order of rows
  std::vector<std::uint32_t> outline_ends;  // by row: the number of rings up to it and with it
  Box bounds;
  FeatureTable features;
};

}  // namespace trapeze
