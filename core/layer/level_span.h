// The items of a layer that tiles of a place may need at any zoom within a range: found once for
// all these tiles, then narrowed down from a place to the places within it.
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

/// A range of levels, inclusive at both ends.
struct LevelRange {
  Level finest = 0;
  Level coarsest = kLastLevel;

  bool meets(Lifespan lifespan) const {
    return lifespan.born <= coarsest && lifespan.dies > finest;
  }
  friend bool operator==(const LevelRange&, const LevelRange&) = default;
};

/// The selection. A part of it has a box within its boxes, and levels and births within its ranges.
struct LevelSpanSelection {
  Box box;       // of trapezoids and edges
  Box dust_box;  // of the remains of small polygons
  LevelRange levels;
  bool has_edges = false;  // horizontal edges, for outlines
  bool has_motes = false;
  LevelRange resolutions;  // at which motes are alive
  GrainIndex::Births births = {1, 0};
};

class LevelSpan {
 public:
  /// Finds the items of features that are drawn according to `classes`; of all features if it is
  /// empty. Returns false and holds nothing if the index counts more than `most` trapezoids there.
  bool find(const Layer& layer, std::span<const std::uint8_t> classes,
            const LevelSpanSelection& selection, std::uint64_t most);
  /// Takes over the items of another span that belong to a part of its selection.
  void narrow(const Layer& layer, const LevelSpan& from, const LevelSpanSelection& selection);

  /// The trapezoids of polygons that may intersect the box, in ascending order. Use their lifespans
  /// to find those alive at a level.
  std::span<const std::uint32_t> polygons() const { return polygons_; }
  /// Horizontal edges, as found by Layer::select_horizontal_edges().
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
