// What of a layer may be met by any tile of a place, whatever its zoom within a range: found once
// for all of them, and narrowed down from a place to the places within it.
//
// Thread-safety: one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/tolerance.h"
#include "core/layer/grains.h"
#include "core/layer/layer.h"

namespace trapeze {

/// Of levels, both ends being part of it.
struct LevelRange {
  Level finest = 0;
  Level coarsest = kLastLevel;

  bool meets(Lifespan lifespan) const {
    return lifespan.born <= coarsest && lifespan.dies > finest;
  }
  friend bool operator==(const LevelRange&, const LevelRange&) = default;
};

/// What is looked at. A part of it has a box within its boxes, and levels and births within its
/// own.
struct LevelSpanSelection {
  Box box;       // of trapezoids and edges
  Box dust_box;  // of what small polygons left behind
  LevelRange levels;
  bool has_edges = false;  // horizontal edges, for outlines
  bool has_motes = false;
  LevelRange resolutions;  // at which motes are alive
  GrainIndex::Births births = {1, 0};
};

class LevelSpan {
 public:
  /// Of the features that `classes` does not leave undrawn; all if it is empty. False, and nothing
  /// is held, if the index counts more than `most` trapezoids there.
  bool find(const Layer& layer, std::span<const std::uint8_t> classes,
            const LevelSpanSelection& selection, std::uint64_t most);
  /// What of another span belongs to a part of its selection.
  void narrow(const Layer& layer, const LevelSpan& from, const LevelSpanSelection& selection);

  /// The trapezoids of polygons that may meet the box, in ascending order; those at one level are
  /// to be told by their lifespans.
  std::span<const std::uint32_t> polygons() const { return polygons_; }
  /// Horizontal edges, as Layer::select_horizontal_edges() has them.
  std::span<const std::uint32_t> edges() const { return edges_; }
  std::span<const std::uint32_t> motes() const { return motes_; }
  std::span<const FeatureGrain* const> grains() const { return grains_; }
  bool empty() const {
    return polygons_.empty() && edges_.empty() && motes_.empty() && grains_.empty();
  }

 private:
  void clear();

  std::vector<std::uint32_t> polygons_;
  std::vector<std::uint32_t> edges_;
  std::vector<std::uint32_t> motes_;
  std::vector<const FeatureGrain*> grains_;
  std::vector<TrapezoidRange> ranges_;  // kept for its memory
};

}  // namespace trapeze
