// Topological consistency for simplified polygons after Corcoran, Mooney and Winstanley (2011): a
// vertex may be removed if no remaining vertex ends up on the other side of the boundary.
//
// The area enclosed by a chain and its chord changes sides. So a chain is consistent if no
// remaining vertex of its polygon is in that area or on its border; otherwise it is split at its
// farthest vertex, until all chains are consistent. Only vertices in the bounding box of the chain
// are examined, which are found in a grid. Two chords then never cross: the ends of one are outside
// the area enclosed by the other chain, so it would have to cross that chain as often as its chord.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/experiment/chains.h"
#include "bench/experiment/map_data.h"

namespace trapeze::experiment {

/// Points in square cells, about two per cell. Memory is kept between uses.
class PointGrid {
 public:
  void assign(std::span<const Point> points);
  /// Whether `is_wanted` holds for one of the points in the box.
  template <class Predicate>
  bool any_in(const Box& box, const Predicate& is_wanted) const {
    if (!bounds_.intersects(box)) return false;
    const std::int64_t first_column = column(box.min_x);
    const std::int64_t last_column = column(box.max_x);
    const std::int64_t last_row = row(box.max_y);
    for (std::int64_t y = row(box.min_y); y <= last_row; ++y) {
      // The cells of a row are consecutive.
      const std::uint32_t begin = begins_[static_cast<std::size_t>(y * columns_ + first_column)];
      const std::uint32_t end = begins_[static_cast<std::size_t>(y * columns_ + last_column) + 1];
      for (std::uint32_t i = begin; i < end; ++i) {
        if (is_wanted(points_[i])) return true;
      }
    }
    return false;
  }

 private:
  std::int64_t column(std::int32_t x) const;
  std::int64_t row(std::int32_t y) const;

  Box bounds_;
  std::int64_t columns_ = 1;
  std::int64_t rows_ = 1;
  std::int64_t side_ = 1;  // of a cell of this grid, in cells of the world's grid
  std::vector<std::uint32_t> begins_;
  std::vector<std::uint32_t> cell_of_;
  std::vector<Point> points_;
};

/// Used by one thread.
class TopologyKeeper {
 public:
  /// Splits chains of polygon `polygon` until all are consistent.
  void keep(const PolygonSet& polygons, std::size_t polygon, RingSimplifier& simplifier,
            PolygonChains& chains);

  /// The number of chains that had to be split so far.
  std::uint64_t splits() const { return splits_; }

 private:
  /// Vertices that chains are tested against, in a grid if there are many.
  struct KeptVertices {
    std::vector<Point> points;
    PointGrid grid;
    bool has_grid = false;
    bool is_indexed = false;

    void index();
  };

  void collect_kept(const PolygonSet& polygons, std::uint32_t first_ring,
                    const PolygonChains& chains);
  /// Tests all chains against `kept`, and those created by splitting against all remaining
  /// vertices.
  void split_inconsistent(const PolygonSet& polygons, std::uint32_t first_ring,
                          RingSimplifier& simplifier, KeptVertices& kept, PolygonChains& chains);
  bool is_consistent(std::span<const Point> ring, const Chain& chain, KeptVertices& kept) const;

  KeptVertices all_kept_;
  KeptVertices last_kept_;         // by the previous round of splitting
  std::vector<Point> newly_kept_;  // by the current round
  PolygonChains next_;
  std::vector<std::pair<Chain, bool>> pending_;  // and whether it was created by splitting
  std::uint64_t splits_ = 0;
};

}  // namespace trapeze::experiment
