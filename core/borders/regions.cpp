#include "core/borders/regions.h"

namespace trapeze {
namespace {

/// Links lead to every node that can be reached without crossing an edge.
class Flood {
 public:
  Flood(const TrapezoidalGraph& graph, Regions& regions) : g_(graph), regions_(regions) {
    region_of_.resize(graph.nodes().size());
    for (std::size_t i = 0; i < graph.nodes().size(); ++i) {
      const NodeId n(i);
      if (!graph.node(n).is_alive() || !region_of_[n].is_none()) continue;
      fill(n, regions.face.push_back(graph.face(graph.node(n))));
    }
  }

  RegionId operator[](NodeId n) const { return region_of_[n]; }

 private:
  void fill(NodeId start, RegionId region) {
    region_of_[start] = region;
    waiting_.assign(1, start);
    while (!waiting_.empty()) {
      const Node& node = g_.node(waiting_.back());
      waiting_.pop_back();
      if (g_.is_frame(node.edge[kLeft])) regions_.unbounded = region;
      for (const auto& links : node.link) {
        for (const NodeId next : links) {
          if (next.is_none() || !region_of_[next].is_none()) continue;
          region_of_[next] = region;
          waiting_.push_back(next);
        }
      }
    }
  }

  const TrapezoidalGraph& g_;
  Regions& regions_;
  Table<NodeId, RegionId> region_of_;
  std::vector<NodeId> waiting_;
};

}  // namespace

Regions::Regions(const TrapezoidalGraph& graph) {
  const Flood flood(graph, *this);
  beside.resize(graph.edges().size());
  std::vector<Int128> doubled(face.size(), 0);
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const EdgeId e(i);
    const Edge& edge = graph.edge(e);
    if (!edge.is_alive() || graph.is_frame(e)) continue;
    for (const Side s : {kLeft, kRight}) beside[e][s] = flood[edge.extreme[s][kUp]];
    const Int128 strip = doubled_strip(graph, edge);
    doubled[beside[e][kLeft].value] += strip;
    doubled[beside[e][kRight].value] -= strip;
  }
  for (const Int128 area_of_region : doubled) {
    area.push_back(static_cast<double>(area_of_region) / 2);
  }
}

}  // namespace trapeze
