#include "core/layer/full_detail.h"

#include <cstddef>
#include <utility>

#include "core/grid/item_count.h"
#include "core/layer/overlaps.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kNoGraph = 0xffffffff;

template <typename Item>
void append(std::vector<Item>& to, const std::vector<Item>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

void FullDetail::note_row(std::uint32_t row, std::uint32_t graph) {
  if (row >= graph_of_.size()) {
    graph_of_.resize(std::size_t{row} + 1, kNoGraph);
    boxes_.resize(std::size_t{row} + 1);
  }
  graph_of_[row] = graph;
}

void FullDetail::add(const TrapezoidalGraph& graph, const FaceFeatures& rows,
                     std::uint32_t number) {
  const auto first_vertex = static_cast<std::uint32_t>(vertices_.size());
  const auto first_edge = static_cast<std::uint32_t>(edges_.size());
  require_countable(trapezoids_.size() + graph.nodes().size(), "trapezoids at full detail");
  const auto vertex = [&](VertexId v) { return first_vertex + v.value - 1; };  // vertex 0 belongs
                                                                               // to the frame
  for (std::size_t v = 1; v <= graph.vertex_count(); ++v) {
    vertices_.push_back(graph.point(VertexId(v)));
  }
  for (std::size_t e = 0; e < graph.edges().size(); ++e) {
    const EdgeId edge(e);
    const auto& end = graph.edge(edge).end;
    edges_.push_back(graph.is_frame(edge) ? MeshEdge{}
                                          : MeshEdge{vertex(end[kUp]), vertex(end[kDown])});
  }
  for (const NodeId n : graph.inside_nodes()) {
    const Node& node = graph.node(n);
    for (const std::uint32_t row : rows.of(graph.face(node))) {
      note_row(row, number);
      for (const EdgeId edge : node.edge) {
        for (const VertexId end : graph.edge(edge).end) boxes_[row].include(graph.point(end));
      }
      trapezoids_.push_back({vertex(node.end[kUp]), vertex(node.end[kDown]),
                             first_edge + node.edge[kLeft].value,
                             first_edge + node.edge[kRight].value});
      row_of_.push_back(row);
    }
  }
  for (const auto& several : rows.shared()) append(rows_in_common_, several);
}

void FullDetail::add(FullDetail&& other) {
  const auto first_vertex = static_cast<std::uint32_t>(vertices_.size());
  const auto first_edge = static_cast<std::uint32_t>(edges_.size());
  require_countable(trapezoids_.size() + other.trapezoids_.size(), "trapezoids at full detail");
  append(vertices_, other.vertices_);
  for (const MeshEdge& e : other.edges_) {
    edges_.push_back({first_vertex + e.upper, first_vertex + e.lower});
  }
  for (const MeshTrapezoid& t : other.trapezoids_) {
    trapezoids_.push_back(
        {first_vertex + t.top, first_vertex + t.bottom, first_edge + t.left, first_edge + t.right});
  }
  append(row_of_, other.row_of_);
  append(rows_in_common_, other.rows_in_common_);
  for (std::uint32_t row = 0; row < other.graph_of_.size(); ++row) {
    if (other.graph_of_[row] == kNoGraph) continue;
    note_row(row, other.graph_of_[row]);
    boxes_[row].include(other.boxes_[row]);
  }
  other = {};
}

std::vector<std::uint8_t> FullDetail::overlapping(unsigned threads) const {
  std::vector<std::uint8_t> result(graph_of_.size(), 0);
  const std::vector<Lifespan> lifespans(trapezoids_.size());
  const FeatureOverlaps found = find_overlaps(
      {{0, vertices_, edges_, trapezoids_}, lifespans, row_of_, graph_of_, boxes_}, {}, threads);
  for (const FeatureOverlap& pair : found.pairs) result[pair.row] = 1;
  for (const std::uint32_t row : rows_in_common_) result[row] = 1;
  return result;
}

}  // namespace trapeze
