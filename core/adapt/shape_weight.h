// Vertex weights by shape: effective area, weighed.
//
// As with effective area, what changes the area of the shape least is taken away, again and again.
// Two things are different. First, areas are multiplied by how much their form matters (Zhou and
// Jones, Shape-Aware Line Generalisation with Weighted Effective Area, 2005, the paper's reference
// 22): flat triangles, and skew ones, count less than their area, and those at right angles more.
// Second, what is taken away is one vertex or both ends of an edge, whichever counts less: both
// ends of the step in a wall, or of a bump, go at one tolerance, and so do the four corners of a
// rectangle when nothing else is left of it.
//
// Of the filters that Zhou and Jones propose, that of convexity is not there: what juts out on one
// side of a shared border recedes on the other, and both have to agree on its weight. Nor are their
// functions used: those here have no more in them than sums, products, quotients and square roots
// of doubles, which IEEE 754 rounds alike everywhere.
//
// Thread-safety: a ShapeWeights may be used by one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"

namespace trapeze {

class ShapeWeights {
 public:
  enum class Line : std::uint8_t { ring, arc };

  /// Writes the weights, in cells, of all vertices but two: of the ends of an arc, and of the two
  /// of a ring that nothing is left of without. They depend neither on the first point of a ring
  /// nor on the direction, and none is less than that of a vertex removed before. `weights` is as
  /// long as `points`: a ring has three or more, an arc two or more.
  void weigh(std::span<const Point> points, Line line, std::span<double> weights);

 private:
  // One vertex, or two that follow each other: what it would cost to remove them.
  struct Candidate {
    double cost;
    Point upper;  // of the two; both are the same where there is one
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
  std::vector<double> cost_of_one_;   // by vertex, as it was enqueued last
  std::vector<double> cost_of_pair_;  // by the first of both
  std::vector<Candidate> queue_;      // a heap
};

/// What it costs to remove v from between p and q, in cells squared: the area of the triangle,
/// times a filter of its form. It does not matter which of p and q comes first.
double cost_of_vertex(Point p, Point v, Point q);

/// The same of two vertices v and w from p, v, w, q: the area between the old and the new boundary.
double cost_of_pair(Point p, Point v, Point w, Point q);

}  // namespace trapeze
