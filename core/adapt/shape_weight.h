// Vertex weights by shape: effective area, weighed.
//
// As with effective area, the vertex that changes the area of the shape least is removed,
// repeatedly. Two things differ. First, areas are multiplied by a factor for their form (Zhou and
// Jones, Shape-Aware Line Generalisation with Weighted Effective Area, 2005, the paper's reference
// 22): flat and skew triangles count less than their area, right-angled ones more. Second, a
// removal takes one vertex or both ends of an edge, whichever costs less: both ends of the step in
// a wall, or of a bump, are removed at one tolerance, and so are the four corners of a rectangle
// when nothing else is left of it.
//
// The convexity filter that Zhou and Jones propose is omitted: what juts out on one side of a
// shared border recedes on the other, and both sides must agree on its weight. Their functions are
// not used either: those here consist only of sums, products, quotients and square roots of
// doubles, which IEEE 754 rounds alike everywhere.
//
// Thread-safety: one thread at a time per ShapeWeights.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"

namespace trapeze {

/// Instead of the index of a vertex: none.
constexpr std::size_t kNoIndex = static_cast<std::size_t>(-1);

/// The area of the triangle abc, in cells squared.
inline double triangle_area(Point a, Point b, Point c) {
  return std::abs(static_cast<double>(orientation(a, b, c))) / 2;
}

class ShapeWeights {
 public:
  enum class Line : std::uint8_t { ring, arc };

  /// Writes the weights, in cells, of all vertices but two: the ends of an arc, or the two vertices
  /// without which nothing is left of a ring. Weights depend neither on the first point of a ring
  /// nor on its direction, and none is less than that of a vertex removed before. `weights` is as
  /// long as `points`: at least three for a ring, at least two for an arc.
  void weigh(std::span<const Point> points, Line line, std::span<double> weights);

 private:
  // One vertex, or two consecutive ones, with the cost of removing them.
  struct Candidate {
    double cost;
    Point upper;  // of the two vertices; both are the same if there is only one
    Point lower;
    std::size_t first;
    std::size_t last;

    bool operator<(const Candidate& other) const;
  };

  void enqueue_one(std::size_t v);
  void enqueue_pair(std::size_t first);
  void enqueue(double cost, std::size_t first, std::size_t last);
  bool is_stale(const Candidate& candidate) const;
  bool is_end(std::size_t v) const;

  std::span<const Point> points_;
  Line line_ = Line::ring;
  std::size_t left_ = 0;
  std::vector<std::size_t> before_;
  std::vector<std::size_t> after_;
  std::vector<double> cost_of_one_;   // by vertex, as last enqueued
  std::vector<double> cost_of_pair_;  // by the first vertex of the pair
  std::vector<Candidate> queue_;      // a heap
};

/// The cost of removing v between p and q, in cells squared: the area of the triangle times a
/// filter of its form. Symmetric in p and q.
double cost_of_vertex(Point p, Point v, Point q);

/// The same for two vertices v and w in p, v, w, q: the area between the old and the new boundary.
double cost_of_pair(Point p, Point v, Point w, Point q);

}  // namespace trapeze
