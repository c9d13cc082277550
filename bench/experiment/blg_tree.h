// Binary line generalization trees (van Oosterom 1989): Douglas and Peucker's partitioning of every
// ring, computed once. A view descends as far as its tolerance requires, and touches nothing below.
#pragma once

#include <vector>

#include "bench/experiment/chains.h"
#include "bench/experiment/map_data.h"

namespace trapeze::experiment {

class BlgTrees final : public RingSimplifier {
 public:
  /// Builds the trees. `polygons` must outlive this.
  explicit BlgTrees(const PolygonSet& polygons);

  void simplify(std::uint32_t ring, double epsilon, std::vector<Chain>& chains) override;
  std::pair<Chain, Chain> split(std::uint32_t ring, const Chain& chain) override;
  std::size_t memory() const override;

 private:
  struct Node {
    std::uint32_t vertex;
    std::uint32_t before;  // node that splits the chain before the vertex, or kNoVertex
    std::uint32_t after;
    double distance;  // cells
  };

  Chain chain(std::uint32_t begin, std::uint32_t end, std::uint32_t node) const;
  std::pair<Chain, Chain> halves(const Chain& chain) const;

  const PolygonSet& polygons_;
  std::vector<Node> nodes_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> roots_;  // by ring: of its two chains
  std::vector<Chain> pending_;
};

}  // namespace trapeze::experiment
