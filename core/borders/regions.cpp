#include "core/borders/regions.h"

#include <algorithm>

namespace trapeze {
namespace {

/// The region of every node: links lead to everything reachable without crossing an edge.
class NodeRegions {
 public:
  NodeRegions(const TrapezoidalGraph& graph, Regions& regions) {
    const std::size_t count = graph.nodes().size();
    first_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) first_.push_back(NodeId(i));
    for (std::size_t i = 0; i < count; ++i) {
      const Node& node = graph.node(NodeId(i));
      if (!node.is_alive()) continue;
      for (const Side s : {kLeft, kRight}) {
        const NodeId above = node.link[s][kUp];
        if (!above.is_none()) unite(NodeId(i), above);
      }
    }
    region_of_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const NodeId n(i);
      const Node& node = graph.node(n);
      if (!node.is_alive()) continue;
      // The first node of a region precedes all other nodes of it.
      const NodeId first = find(n);
      region_of_[n] = first == n ? regions.face.push_back(graph.face(node)) : region_of_[first];
      if (graph.is_frame(node.edge[kLeft])) regions.unbounded = region_of_[n];
    }
  }

  RegionId operator[](NodeId n) const { return region_of_[n]; }

 private:
  NodeId find(NodeId n) {
    while (first_[n] != n) n = first_[n] = first_[first_[n]];
    return n;
  }
  void unite(NodeId a, NodeId b) {
    a = find(a);
    b = find(b);
    first_[std::max(a, b)] = std::min(a, b);
  }

  Table<NodeId, NodeId> first_;  // leads to the first node of the region
  Table<NodeId, RegionId> region_of_;
};

}  // namespace

Regions::Regions(const TrapezoidalGraph& graph) {
  const NodeRegions region_of(graph, *this);
  beside.resize(graph.edges().size());
  std::vector<Int128> doubled(face.size(), 0);
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const EdgeId e(i);
    const Edge& edge = graph.edge(e);
    if (!edge.is_alive() || graph.is_frame(e)) continue;
    for (const Side s : {kLeft, kRight}) beside[e][s] = region_of[edge.extreme[s][kUp]];
    const Int128 strip = doubled_strip(graph, edge);
    doubled[beside[e][kLeft].value] += strip;
    doubled[beside[e][kRight].value] -= strip;
  }
  for (const Int128 area_of_region : doubled) {
    area.push_back(static_cast<double>(area_of_region) / 2);
  }
}

}  // namespace trapeze
