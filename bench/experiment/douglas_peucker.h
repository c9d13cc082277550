// Douglas and Peucker's simplification, repeated for every view.
#pragma once

#include "bench/experiment/chains.h"
#include "bench/experiment/map_data.h"
#include "core/adapt/farthest_vertex.h"

namespace trapeze::experiment {

class DouglasPeucker final : public RingSimplifier {
 public:
  /// `polygons` must outlive this object.
  explicit DouglasPeucker(const PolygonSet& polygons) : polygons_(polygons) {}

  void simplify(std::uint32_t ring, double epsilon, std::vector<Chain>& chains) override;
  std::pair<Chain, Chain> split(std::uint32_t ring, const Chain& chain) override;
  std::size_t memory() const override { return 0; }

 private:
  Chain measured(std::uint32_t begin, std::uint32_t end);

  const PolygonSet& polygons_;
  FarthestVertex farthest_;
  std::vector<Chain> pending_;
};

}  // namespace trapeze::experiment
