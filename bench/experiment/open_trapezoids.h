// Trapezoidation by open trapezoids (Zalik and others 2003) for contestants that need only the
// trapezoids and no graph: a plane sweep that keeps the edges on the sweep line in order, and
// closes and opens trapezoids as it passes vertices.
//
// Small polygons have few edges on the sweep line, so these are stored in an array. The sweep goes
// from the top of the view to its bottom, and trapezoids outside the view are not written.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/experiment/trapezoid_list.h"
#include "core/grid/rings.h"
#include "core/sweep/graph_builder.h"

namespace trapeze::experiment {

/// Used by one thread; memory is kept between uses.
class OpenTrapezoids {
 public:
  enum class Boundary : std::uint8_t {
    simple,     // edges meet at shared vertices only; checked only where it matters
    uncertain,  // edges that become neighbours are tested, and noded if necessary
  };

  /// Appends the trapezoids, by the even-odd rule, of rings `first` .. `last` - 1 that intersect
  /// `view`, clipped at its top and bottom.
  void tessellate(const Rings& rings, std::uint32_t first, std::uint32_t last, const Box& view,
                  Boundary boundary, TrapezoidList& trapezoids);

  /// The number of polygons that had to be noded so far.
  std::uint64_t noded() const { return noded_; }

 private:
  struct Edge {
    Point upper;
    Point lower;
  };
  struct Visit {
    std::uint64_t key;   // of the vertex in sweep order
    std::uint32_t edge;  // starts at the vertex
    std::uint32_t edge_before;
  };
  struct Slot {
    Edge edge;
    std::int32_t top;  // level at which the area right of the edge was opened
  };

  void collect(const Rings& rings, std::uint32_t first, std::uint32_t last, const Box& view);
  bool start(const Box& view, Boundary boundary);
  bool sweep(const Box& view, Boundary boundary, TrapezoidList& trapezoids);
  bool sweep_vertex(std::size_t begin, std::size_t end, Boundary boundary, const Box& view,
                    TrapezoidList& trapezoids);
  void close_intervals(std::size_t begin, std::size_t end, std::int32_t bottom, const Box& view,
                       TrapezoidList& trapezoids) const;
  std::size_t locate(Point p) const;
  bool replace(std::size_t position, std::size_t count, Point p);
  bool is_apart(std::size_t left) const;
  void tessellate_noded(const Rings& rings, std::uint32_t first, std::uint32_t last,
                        const Box& view, TrapezoidList& trapezoids);

  std::vector<Edge> edges_;
  std::vector<Visit> visits_;
  std::vector<std::pair<double, Edge>> crossing_;  // at the top of the view: x, edge
  std::vector<Slot> status_;
  std::vector<Edge> starting_;
  GraphBuilder builder_;
  TrapezoidalGraph graph_;
  Rings noded_rings_;
  std::uint64_t noded_ = 0;
};

}  // namespace trapeze::experiment
