// The result of simplifying a ring by recursive partitioning: the remaining vertices, and between
// each two of them a chain of removed vertices.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/grid/rings.h"

namespace trapeze::experiment {

constexpr std::uint32_t kNoVertex = 0xffffffff;

/// Vertices begin .. end of a ring, of which only the ends remain. An `end` equal to the number of
/// vertices means the first one.
struct Chain {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::uint32_t split = kNoVertex;  // the vertex farthest from the chord; none if there is none
  std::uint32_t node = kNoVertex;   // in a BLG tree: the node of `split`
  double distance = 0;              // of `split` from the chord, cells

  bool has_dropped() const { return split != kNoVertex; }
};

/// The chains of a polygon, ring after ring. A ring of two chains has only its anchors left, so it
/// counts as removed.
struct PolygonChains {
  std::vector<Chain> chains;
  std::vector<std::uint32_t> ends;  // by ring

  void clear() {
    chains.clear();
    ends.clear();
  }
  std::uint32_t first(std::size_t ring) const { return ring == 0 ? 0 : ends[ring - 1]; }
  bool has_gone(std::size_t ring) const { return ends[ring] - first(ring) < 3; }
};

/// Simplifies the rings of one PolygonSet. Used by one thread.
class RingSimplifier {
 public:
  virtual ~RingSimplifier() = default;

  /// Appends the chains of a ring at a tolerance (cells): a vertex remains if it is at least that
  /// far from the chord that it splits.
  virtual void simplify(std::uint32_t ring, double epsilon, std::vector<Chain>& chains) = 0;

  /// Both parts of a chain that has removed vertices.
  virtual std::pair<Chain, Chain> split(std::uint32_t ring, const Chain& chain) = 0;

  /// Heap memory kept between views, in bytes.
  virtual std::size_t memory() const = 0;
};

}  // namespace trapeze::experiment
