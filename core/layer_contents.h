// The stored arrays of a layer; private to Layer and LayerBuilder.
#pragma once

#include <cstdint>
#include <vector>

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
  TrapezoidRange polygons;                // trapezoids of polygons, then
  TrapezoidRange dust;                    // trapezoids of dust
  MeshIndex polygon_index;
  MeshIndex dust_index;
  Size size;
  Box bounds;
  FeatureTable features;
};

}  // namespace trapeze
