// Trapezoidation by open trapezoids (Zalik and others 2003) for those who need the trapezoids alone
// and no graph: a plane sweep that keeps the edges on the sweep line in order, and closes and opens
// trapezoids as it passes vertices.
//
// Small polygons have few edges on the sweep line, so these lie in an array. The sweep goes from
// the top of the view to its bottom, and trapezoids that do not meet the view are not written down.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/experiment/trapezoid_list.h"
#include "core/grid/rings.h"
#include "core/sweep/graph_builder.h"

namespace trapeze::experiment {

/// Belongs to one thread; memory is kept between uses.
class OpenTrapezoids {
 public:
  enum class Boundary : std::uint8_t {
    simple,     // edges meet at common vertices only; found out only where it gets in the way
    uncertain,  // edges that come to lie side by side are tested, and noded if need be
  };

  /// Appends the trapezoids, by even-odd, of rings `first` .. `last` - 1 that meet `view`, cut at
  /// its top and bottom.
  void tessellate(const Rings& rings, std::uint32_t first, std::uint32_t last, const Box& view,
                  Boundary boundary, TrapezoidList& trapezoids);

  /// Polygons that had to be noded so far.
  std::uint64_t noded() const { return noded_; }

 private:
  struct Edge {
    Point upper;
    Point lower;
  };
  struct Visit {
    std::uint64_t key;   // of the vertex in sweep order
    std::uint32_t edge;  // that leaves it
    std::uint32_t edge_before;
  };
  struct Slot {
    Edge edge;
    std::int32_t top;  // level at which what lies right of the edge was opened
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
  std::vector<std::pair<double, Edge>> crossing_;  // the top of the view, and where
  std::vector<Slot> status_;
  std::vector<Edge> starting_;
  GraphBuilder builder_;
  TrapezoidalGraph graph_;
  Rings noded_rings_;
  std::uint64_t noded_ = 0;
};

}  // namespace trapeze::experiment
