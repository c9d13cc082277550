#include "server/tiles/loop_length_cache.h"

#include <algorithm>
#include <utility>

namespace trapeze {
namespace {

Box box_of_outline(const Layer& layer, std::uint32_t row) {
  Rings rings;
  layer.append_outline(row, rings);
  Box box;
  for (const Point p : rings.points) box.include(p);
  return box;
}

/// The different edges of the feature's trapezoids that may touch the box.
std::vector<std::uint32_t> edges_of(const Layer& layer, Level level, std::uint32_t row,
                                    const Box& box) {
  const MeshView& mesh = layer.mesh();
  std::vector<std::uint32_t> edges;
  const auto add = [&](const std::vector<TrapezoidRange>& ranges) {
    for_each_trapezoid(ranges, [&](std::uint32_t i) {
      if (layer.feature_of(i) != row) return;
      edges.push_back(mesh.trapezoids[i].left);
      edges.push_back(mesh.trapezoids[i].right);
    });
  };
  std::vector<TrapezoidRange> ranges;
  layer.select({box, level, kLastLevel, SmallPolygons::drop}, ranges);
  add(ranges);
  layer.select_horizontal_edges(box, level, ranges);
  add(ranges);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// Every vertex has an even number of edges.
bool are_closed(const MeshView& mesh, const std::vector<std::uint32_t>& edges) {
  std::vector<std::uint32_t> ends;
  for (const std::uint32_t edge : edges) {
    ends.push_back(mesh.edges[edge].upper);
    ends.push_back(mesh.edges[edge].lower);
  }
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    if (i + 1 == ends.size() || ends[i] != ends[i + 1]) return false;
  }
  return true;
}

/// Three times as wide and high, as far as there is a grid.
Box widened(const Box& box) {
  const auto cell = [](std::int64_t v) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, kGridMin, kGridMax));
  };
  const std::int64_t width = std::int64_t{box.max_x} - box.min_x + 1;
  const std::int64_t height = std::int64_t{box.max_y} - box.min_y + 1;
  return {cell(box.min_x - width), cell(box.min_y - height), cell(box.max_x + width),
          cell(box.max_y + height)};
}

/// Between neighbours, a feature can reach beyond its outline: it has been given what was too small
/// to see.
std::vector<LoopEdge> measure(const Layer& layer, Level level, std::uint32_t row) {
  constexpr Box kWorld{kGridMin, kGridMin, kGridMax, kGridMax};
  Box box = box_of_outline(layer, row);
  if (box.is_empty()) return {};
  std::vector<std::uint32_t> edges = edges_of(layer, level, row, box);
  while (!are_closed(layer.mesh(), edges) && box != kWorld) {
    box = widened(box);
    edges = edges_of(layer, level, row, box);
  }
  return measure_loops(layer.mesh(), std::move(edges));
}

}  // namespace

const std::vector<LoopEdge>& LoopLengthCache::find(const Layer& layer, Level level,
                                                   std::uint32_t row) {
  const Key key{layer.mesh().id, row, level};
  if (const auto* edges = outlines_.find(key)) return *edges;
  constexpr std::size_t kOverhead = 128;  // of an entry, about
  std::vector<LoopEdge> edges = measure(layer, level, row);
  const std::size_t bytes = kOverhead + edges.size() * sizeof(LoopEdge);
  return outlines_.insert(key, std::move(edges), bytes);
}

}  // namespace trapeze
