// The paper's contestant: one mutable trapezoidal graph per polygon, adapted in place to the
// tolerance of the view, forward and back. Vertices are sent once; a view sends the numbers of the
// vertices of its trapezoids.
//
// The sequence of removals is computed while the map is prepared; views play it forward and back.
// The top of a polygon's priority stack shows whether a tolerance changes it at all, and its
// trapezoids are listed again only after it has changed.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "bench/experiment/contestant.h"
#include "bench/experiment/numbered_trapezoids.h"
#include "core/adapt/adaptable_graph.h"

namespace trapeze::experiment {

/// Trapezoids in the form in which they are sent.
using NumberedList = std::vector<VertexNumbers>;

/// The graphs of a layer. Used by one thread.
class AdaptingLayer {
 public:
  /// Appends its vertices to `vertices`, which are those of all layers and must outlive it.
  AdaptingLayer(const PolygonSet& polygons, Topology topology, std::vector<Point>& vertices);

  /// Resets all graphs to full detail.
  void start_run();
  /// Adapts the graphs of all polygons that intersect the box to the tolerance.
  void adapt(const Box& box, double epsilon);
  /// Appends the trapezoids of these polygons, except those outside the box.
  void append_trapezoids(const Box& box, NumberedList& trapezoids);

 private:
  /// The extent of a trapezoid in x.
  struct Reach {
    std::int32_t min_x = 0;
    std::int32_t max_x = 0;
  };

  // The data that a view reads for every polygon; the graph itself is only needed if it has to
  // change.
  struct Polygon {
    Box box;
    std::uint32_t first_vertex = 0;       // the number of vertex 1 of the graph
    bool is_listed = false;               // `trapezoids` are those of the graph
    AdaptableGraph::Unchanged unchanged;  // the top of its priority stack
    NumberedList trapezoids;
    std::vector<Reach> reaches;  // of these trapezoids
  };

  void adapt(std::size_t polygon, double epsilon);
  void list(std::size_t polygon);
  void append_within(const Polygon& polygon, std::uint32_t vertex_count, const Box& box,
                     NumberedList& trapezoids) const;

  const std::vector<Point>& vertices_;
  std::vector<Polygon> polygons_;
  std::deque<AdaptableGraph> graphs_;  // by polygon
};

class Adapting final : public Contestant {
 public:
  Adapting(Topology topology, const Map& map, Screen& screen);

  void start_run() override;
  std::uint64_t sent_before() const override { return vertices_.size() * sizeof(Point); }
  ViewCost draw(const ScaledView& view, std::vector<Mask>& masks) override;

 private:
  std::vector<Point> vertices_;
  std::deque<AdaptingLayer> layers_;
  std::unique_ptr<NumberedTrapezoids> device_;
  NumberedList trapezoids_;          // of all layers
  std::vector<std::uint32_t> ends_;  // by layer
};

}  // namespace trapeze::experiment
