// The paper's contestant: one mutable trapezoidal graph a polygon, adapted in place to the tolerance
// of the view, forward and back. Vertices are sent once; a view sends the numbers of the vertices of
// its trapezoids.
//
// The sequence of removals is found while the map is prepared; views play it forward and back.
// Trapezoids of a polygon are listed again only after its graph has changed.
#pragma once

#include <deque>
#include <vector>

#include "bench/experiment/contestant.h"
#include "bench/experiment/numbered_trapezoids.h"
#include "core/adaptable_graph.h"

namespace trapeze::experiment {

/// The graphs of a layer. Belongs to one thread.
class AdaptingLayer {
 public:
  AdaptingLayer(const PolygonSet& polygons, Topology topology, Screen& screen);

  void start_run();
  /// Brings the graphs of all polygons that meet the box to the tolerance.
  void adapt(const Box& box, double epsilon);
  /// Those of the box, as adapted, outside of which levels need not be drawn.
  const std::vector<VertexNumbers>& list_trapezoids(const Box& box);
  NumberedTrapezoids& device() { return *device_; }
  std::size_t vertex_count() const { return vertices_.size(); }

 private:
  // What a view looks at for every polygon; the graph itself only if it has to change.
  struct Polygon {
    Box box;
    std::uint32_t first_vertex = 0;       // the number of vertex 1 of the graph
    bool is_listed = false;               // `trapezoids` are those of the graph
    AdaptableGraph::Unchanged unchanged;  // the top of its priority stack
    std::vector<VertexNumbers> trapezoids;
  };

  void adapt(std::size_t polygon, double epsilon);
  void list(std::size_t polygon);
  void append_in_box(std::size_t polygon, const Box& box);

  std::vector<Polygon> polygons_;
  std::deque<AdaptableGraph> graphs_;  // by polygon
  std::vector<Point> vertices_;
  std::vector<VertexNumbers> in_box_;
  std::unique_ptr<NumberedTrapezoids> device_;
};

class Adapting final : public Contestant {
 public:
  Adapting(Topology topology, const Map& map, Screen& screen);

  void start_run() override;
  std::uint64_t sent_before() const override;
  ViewCost draw(const ScaledView& view, std::vector<Coverage>& coverages) override;

 private:
  std::deque<AdaptingLayer> layers_;
};

}  // namespace trapeze::experiment
