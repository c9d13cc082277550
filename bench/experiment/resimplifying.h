// The contestants that simplify and tessellate again for every view: with Douglas and Peucker's
// algorithm or with BLG trees, into trapezoids or triangles.
#pragma once

#include <memory>
#include <vector>

#include "bench/experiment/contestant.h"
#include "bench/experiment/open_trapezoids.h"
#include "bench/experiment/simplified_polygons.h"
#include "bench/experiment/topology_keeper.h"
#include "bench/experiment/triangulation.h"

namespace trapeze::experiment {

/// Simplifies the polygons of a layer that intersect a box. Used by one thread.
class LayerSimplifier {
 public:
  /// `polygons` must outlive this object.
  LayerSimplifier(const PolygonSet& polygons, std::unique_ptr<RingSimplifier> rings,
                  Topology topology)
      : polygons_(polygons), rings_(std::move(rings)), topology_(topology) {}

  /// Replaces `simplified`. Leaves out rings with fewer than three remaining vertices, and polygons
  /// without a shell.
  void simplify(const Box& box, double epsilon, SimplifiedPolygons& simplified);

  const TopologyKeeper& keeper() const { return keeper_; }

 private:
  void append(std::size_t polygon, SimplifiedPolygons& simplified) const;

  const PolygonSet& polygons_;
  std::unique_ptr<RingSimplifier> rings_;
  const Topology topology_;
  TopologyKeeper keeper_;
  PolygonChains chains_;
};

/// `method` is one of douglas_peucker, blg_tree, triangulation, whole_map.
std::unique_ptr<RingSimplifier> make_ring_simplifier(Method method, const PolygonSet& polygons);

class Resimplifying final : public Contestant {
 public:
  Resimplifying(Method method, Topology topology, const Map& map, Screen& screen);

  std::size_t shared_memory() const override;
  ViewCost draw(const ScaledView& view, std::vector<Mask>& masks) override;

 private:
  void tessellate(const SimplifiedPolygons& simplified, const Box& box);

  const Map& map_;
  const Topology topology_;
  const bool is_whole_map_;  // includes polygons outside the view
  std::vector<LayerSimplifier> layers_;
  OpenTrapezoids open_trapezoids_;
  std::unique_ptr<Triangulation> triangulation_;  // null for contestants that draw trapezoids
  DeviceTrapezoids device_;
  std::vector<SimplifiedPolygons> simplified_;  // by layer
  TrapezoidList trapezoids_;                    // of all layers
  std::vector<std::uint32_t> ends_;             // by layer
};

}  // namespace trapeze::experiment
