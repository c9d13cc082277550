// Prints the rings of a file of polygons, simplified to a tolerance: simplify_rings FILE METRES
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <utility>

#include "core/adapt/adaptable_graph.h"
#include "core/borders/polygons.h"
#include "core/grid/web_mercator.h"
#include "core/io/load/load_layer.h"
#include "core/sweep/graph_builder.h"

namespace {

void print_rings(const trapeze::Polygons& polygons) {
  for (std::size_t i = 0; i < polygons.rings.size(); ++i) {
    for (const trapeze::Point p : polygons.rings[i]) {
      const trapeze::LonLat position = trapeze::lonlat_from_grid(p.x, p.y);
      std::printf(" %.5f,%.5f", position.lon, position.lat);
    }
    std::printf("\n");
  }
}

/// The tolerance is in metres of EPSG:3857, which are longer than those on the ground.
void simplify(const char* file, double metres) {
  const double cells = trapeze::grid_from_metres(metres, 0).x;
  const trapeze::LoadedLayer loaded = trapeze::load_layer(file);
  trapeze::GraphBuilder builder;
  for (std::uint32_t row = 0; row < loaded.layer->features().size(); ++row) {
    trapeze::Rings rings;
    loaded.layer->append_outline(row, rings);
    trapeze::TrapezoidalGraph graph;
    if (!builder.build(rings, graph).built) continue;
    trapeze::AdaptableGraph adaptable(std::move(graph));
    adaptable.adapt_to(cells);
    std::printf("feature %lld\n", static_cast<long long>(loaded.layer->features().id(row)));
    print_rings(trapeze::polygons_of(adaptable.graph()));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: simplify_rings FILE METRES\n");
    return 2;
  }
  try {
    simplify(argv[1], std::strtod(argv[2], nullptr));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "simplify_rings: %s\n", error.what());
    return 1;
  }
}
