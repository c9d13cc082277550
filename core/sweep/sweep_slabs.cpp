#include "core/sweep/sweep_slabs.h"

#include <algorithm>

namespace trapeze {
namespace {

/// An edge where it meets a row: at x / height. From one row to the next below, x grows by `lean` /
/// height.
struct Crossed {
  EdgeId edge;
  std::int64_t x;
  std::int64_t lean;
  std::int64_t height;
};

/// From left to right just above the row; exact.
bool is_left(const Crossed& a, const Crossed& b) {
  const Int128 a_x = static_cast<Int128>(a.x) * b.height;
  const Int128 b_x = static_cast<Int128>(b.x) * a.height;
  if (a_x != b_x) return a_x < b_x;
  const Int128 a_lean = static_cast<Int128>(a.lean) * b.height;
  const Int128 b_lean = static_cast<Int128>(b.lean) * a.height;
  return a_lean != b_lean ? a_lean > b_lean : a.edge < b.edge;
}

}  // namespace

std::vector<VertexId> cut_into_slabs(const Boundary& boundary, std::size_t slabs) {
  constexpr std::size_t kFewest = 8192;  // minimum number of vertices of a slab
  const std::size_t end = boundary.vertices.size() - 1;
  const std::size_t most =
      std::clamp<std::size_t>(end / kFewest, 1, std::max<std::size_t>(slabs, 1));
  std::vector<VertexId> firsts = {VertexId(1)};
  for (std::size_t i = 1; i < most; ++i) {
    std::size_t v = std::max<std::size_t>(1 + (end - 1) * i / most, firsts.back().value + 1u);
    while (v < end && boundary.vertices[VertexId(v)].y == boundary.vertices[VertexId(v - 1)].y) ++v;
    if (v >= end) break;
    firsts.emplace_back(v);
  }
  firsts.emplace_back(end);
  return firsts;
}

std::vector<EdgeId> edges_across(const Boundary& boundary, VertexId first) {
  const std::int64_t y = boundary.vertices[first].y;
  std::vector<Crossed> crossed;
  for (std::size_t i = 0; i < boundary.edges.size(); ++i) {
    const Boundary::Ends ends = boundary.edges[EdgeId(i)];
    if (!(ends.upper < first) || ends.lower < first) continue;
    const Point a = boundary.vertices[ends.upper];
    const Point b = boundary.vertices[ends.lower];
    const std::int64_t lean = std::int64_t{b.x} - a.x;
    const std::int64_t height = std::int64_t{b.y} - a.y;
    crossed.push_back({EdgeId(i), a.x * height + lean * (y - a.y), lean, height});
  }
  std::sort(crossed.begin(), crossed.end(), is_left);
  std::vector<EdgeId> edges;
  edges.reserve(crossed.size());
  for (const Crossed& item : crossed) edges.push_back(item.edge);
  return edges;
}

}  // namespace trapeze
