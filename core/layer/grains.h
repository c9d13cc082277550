// Finds the grains of a layer by place: what its polygons left behind when they became too small,
// each with its feature. They serve where the dust of one feature must be told from that of
// another; elsewhere motes are drawn, which are fewer (see dust.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/hilbert.h"
#include "core/grid/stored_array.h"
#include "core/grid/tolerance.h"

namespace trapeze {

/// A grain (see history.h) as it is stored.
struct FeatureGrain {
  Point from;
  Point to;
  std::int64_t doubled_area = 0;  // cells squared; negative if it was a hole
  std::uint32_t row = 0;          // of the feature
  std::uint32_t born = 0;         // the level

  Box box() const {
    Box box;
    box.include(from);
    box.include(to);
    return box;
  }
};

/// Sorts grains so that those born in the same octave and near each other on the map are near each
/// other in the array.
void sort_for_index(std::vector<FeatureGrain>& grains);

/// Thread-safety: immutable, any number of threads may read.
class GrainIndex {
 public:
  GrainIndex() = default;
  explicit GrainIndex(StoredArray<FeatureGrain> grains);

  /// Calls visit(grain) for every grain that is born at `level` or before and whose segment may
  /// meet the box.
  template <typename Visit>
  void visit(const Box& box, Level level, const Visit& visit) const {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (blocks_[b].min_born > level || !blocks_[b].box.intersects(box)) continue;
      const std::size_t end = std::min(grains_.size(), (b + 1) * kBlock);
      for (std::size_t i = b * kBlock; i < end; ++i) {
        if (grains_[i].born <= level && grains_[i].box().intersects(box)) visit(grains_[i]);
      }
    }
  }

  /// As many grains as visit() looks at: at least those that it visits.
  std::size_t count_near(const Box& box, Level level) const;

  std::span<const FeatureGrain> grains() const { return grains_; }
  std::size_t memory() const { return grains_.memory() + blocks_.capacity() * sizeof(Block); }

 private:
  static constexpr std::size_t kBlock = 64;
  struct Block {
    Box box;
    std::uint32_t min_born = kNeverDies;
  };

  StoredArray<FeatureGrain> grains_;
  std::vector<Block> blocks_;
};

}  // namespace trapeze
