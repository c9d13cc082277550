#include "core/borders/dividing_edges.h"

#include <cstddef>

#include "core/borders/border_arcs.h"

namespace trapeze {
namespace {

/// Drops the edges with the same face on both sides; returns whether any edges remain.
bool keep_borders(Boundary& boundary, Sides& sides) {
  std::vector<bool> is_kept(sides.size());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    is_kept[i] = sides[i].first != sides[i].second;
    if (is_kept[i]) sides[kept++] = sides[i];
  }
  if (kept == sides.size()) return false;
  sides.resize(kept);
  boundary.keep(is_kept);
  return true;
}

}  // namespace

bool keep_what_divides(Sides& sides, Boundary& boundary, Trapezoidation& trapezoidation,
                       TrapezoidalGraph& graph, unsigned threads) {
  if (!keep_borders(boundary, sides)) {
    BorderArcs::name_faces(sides, graph);
    return true;
  }
  const FaceBeyond given = [&sides](EdgeId e, FaceId) { return sides[e.value].second; };
  return !sides.empty() && trapezoidation.build(boundary, given, graph, threads);
}

}  // namespace trapeze
