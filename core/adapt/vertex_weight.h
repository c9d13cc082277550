// Vertex weights: how much a vertex matters for the shape of its ring (paper, section 3.2).
//
// A weight is a distance in grid cells; a vertex is removed at every tolerance greater than its
// weight. Two corners of a ring, its anchors, have infinite weight: they are removed with the ring.
//
// Thread-safety: one thread at a time per VertexWeights.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/adapt/farthest_vertex.h"
#include "core/adapt/shape_weight.h"
#include "core/grid/grid.h"
#include "core/grid/name_table.h"

namespace trapeze {

enum class WeightRule : std::uint8_t {
  /// Douglas-Peucker distance, lowered to the weight of the parent in the BLG tree where that is
  /// smaller. Removing all vertices of smaller weight than a tolerance is then the same as
  /// Douglas-Peucker at that tolerance.
  douglas_peucker,
  /// The paper's adjustment, Eq. (1): the same distances, but a parent is raised to the greatest
  /// weight of its children, so that no vertex is removed before one split off below it.
  raised_parents,
  /// Visvalingam-Whyatt: the square root of the area of the triangle with the remaining neighbours,
  /// never less than that of a vertex removed before.
  effective_area,
  /// Effective area weighted by shape: flat corners are removed first, right angles last, and both
  /// ends of an edge together if that changes less than one of them alone. See shape_weight.h.
  shape,
};

inline constexpr NameTable<WeightRule, 4> kWeightNames({
    {"douglas-peucker", WeightRule::douglas_peucker},
    {"raised-parents", WeightRule::raised_parents},
    {"effective-area", WeightRule::effective_area},
    {"shape", WeightRule::shape},
});

/// Reusable memory for weighing rings.
class VertexWeights {
 public:
  /// Returns the weight of every vertex of a closed ring of at least three points, in the order
  /// given. The weights depend neither on the first point of the ring nor on its direction. The
  /// span is valid until the next call.
  std::span<const double> weigh(std::span<const Point> ring, WeightRule rule);

  /// The same for an arc of at least two points. Its two ends are kept and have infinite weight;
  /// they may be the same point.
  std::span<const double> weigh_arc(std::span<const Point> arc, WeightRule rule);

 private:
  void split_pieces(std::span<const Point> points, bool raise_parents);
  void weigh_by_distance(std::span<const Point> ring, bool raise_parents);
  void weigh_by_area(std::span<const Point> points, bool is_arc);
  struct Anchors {
    std::size_t first;
    std::size_t second;
  };
  static Anchors anchors_of(std::span<const Point> ring);

  // A piece of the ring between two kept vertices, its ends included. Indices may run past the end
  // of the ring and are taken modulo its length. `parent` is the split above it.
  struct Piece {
    std::size_t begin;
    std::size_t end;
    std::size_t parent;
  };
  FarthestVertex farthest_;
  ShapeWeights shape_;
  std::vector<double> weights_;
  std::vector<Piece> pieces_;
  std::vector<std::pair<std::size_t, std::size_t>> splits_;  // vertex and its parent, parents first
  std::vector<std::size_t> before_;
  std::vector<std::size_t> after_;
};

/// The squared distance of p from the segment ab, in cells squared.
double squared_distance(Point p, Point a, Point b);

}  // namespace trapeze
