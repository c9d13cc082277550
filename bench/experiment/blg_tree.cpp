#include "bench/experiment/blg_tree.h"

#include <cmath>

#include "core/adapt/farthest_vertex.h"

namespace trapeze::experiment {
namespace {

/// A chain whose node has not been created yet, and where to store the number of that node.
struct Unbuilt {
  std::uint32_t begin;
  std::uint32_t end;
  std::uint32_t parent;
  bool is_after;
};

}  // namespace

BlgTrees::BlgTrees(const PolygonSet& polygons) : polygons_(polygons) {
  nodes_.reserve(polygons.rings.points.size());
  roots_.reserve(polygons.rings.size());
  FarthestVertex farthest;
  std::vector<Unbuilt> unbuilt;
  const auto build = [&](std::uint32_t begin, std::uint32_t end) {
    std::uint32_t root = kNoVertex;
    unbuilt.push_back({begin, end, kNoVertex, false});
    while (!unbuilt.empty()) {
      const Unbuilt next = unbuilt.back();
      unbuilt.pop_back();
      if (next.end - next.begin < 2) continue;
      const FarthestVertex::Found found = farthest.find(next.begin, next.end);
      const auto vertex = static_cast<std::uint32_t>(found.vertex);
      const auto number = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back({vertex, kNoVertex, kNoVertex, std::sqrt(found.squared)});
      if (next.parent == kNoVertex) {
        root = number;
      } else {
        (next.is_after ? nodes_[next.parent].after : nodes_[next.parent].before) = number;
      }
      unbuilt.push_back({vertex, next.end, number, true});
      unbuilt.push_back({next.begin, vertex, number, false});
    }
    return root;
  };
  for (std::uint32_t ring = 0; ring < polygons.rings.size(); ++ring) {
    const auto points = polygons.rings[ring];
    const std::uint32_t second = polygons.second_anchors[ring];
    farthest.assign(points);
    const std::uint32_t first_root = build(0, second);
    roots_.emplace_back(first_root, build(second, static_cast<std::uint32_t>(points.size())));
  }
}

void BlgTrees::simplify(std::uint32_t ring, double epsilon, std::vector<Chain>& chains) {
  const auto size = static_cast<std::uint32_t>(polygons_.rings[ring].size());
  const std::uint32_t second = polygons_.second_anchors[ring];
  pending_.push_back(chain(second, size, roots_[ring].second));
  pending_.push_back(chain(0, second, roots_[ring].first));
  while (!pending_.empty()) {
    const Chain next = pending_.back();
    pending_.pop_back();
    if (!next.has_dropped() || next.distance < epsilon) {
      chains.push_back(next);
      continue;
    }
    const auto [before, after] = halves(next);
    pending_.push_back(after);
    pending_.push_back(before);
  }
}

std::pair<Chain, Chain> BlgTrees::split(std::uint32_t, const Chain& chain) {
  return halves(chain);
}

Chain BlgTrees::chain(std::uint32_t begin, std::uint32_t end, std::uint32_t node) const {
  if (node == kNoVertex) return {.begin = begin, .end = end};
  return {begin, end, nodes_[node].vertex, node, nodes_[node].distance};
}

std::pair<Chain, Chain> BlgTrees::halves(const Chain& whole) const {
  const Node& node = nodes_[whole.node];
  return {chain(whole.begin, node.vertex, node.before), chain(node.vertex, whole.end, node.after)};
}

std::size_t BlgTrees::memory() const {
  return nodes_.capacity() * sizeof(Node) + roots_.capacity() * sizeof(roots_[0]);
}

}  // namespace trapeze::experiment
