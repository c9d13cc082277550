#include "server/loop_length_cache.h"

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

std::vector<LoopEdge> measure(const Layer& layer, Level level, std::uint32_t row) {
  const Box box = box_of_outline(layer, row);
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
  layer.select_level_edges(box, level, ranges);
  add(ranges);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return measure_loops(mesh, std::move(edges));
}

}  // namespace

const std::vector<LoopEdge>& LoopLengthCache::find(const Layer& layer, Level level,
                                                   std::uint32_t row) {
  const Key key{layer.mesh().id, row, level};
  if (const auto found = by_key_.find(key); found != by_key_.end()) {
    entries_.splice(entries_.begin(), entries_, found->second);
    return entries_.front().edges;
  }
  entries_.push_front({key, measure(layer, level, row)});
  by_key_.emplace(key, entries_.begin());
  const auto bytes_of = [](const Entry& entry) {
    return sizeof(Entry) + entry.edges.size() * sizeof(LoopEdge);
  };
  bytes_ += bytes_of(entries_.front());
  while (bytes_ > budget_ && entries_.size() > 1) {
    bytes_ -= bytes_of(entries_.back());
    by_key_.erase(entries_.back().key);
    entries_.pop_back();
  }
  return entries_.front().edges;
}

}  // namespace trapeze
