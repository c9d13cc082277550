// Finds the grains of a layer by place: what its polygons left behind when they became too small,
// each with its feature. Grains serve where the dust of one feature must be distinguished from that
// of another. Elsewhere motes are drawn, which are fewer (see dust.h).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/hilbert.h"
#include "core/grid/stored_array.h"
#include "core/grid/tolerance.h"
#include "core/layer/dust.h"

namespace trapeze {

/// The stored form of a grain (see history.h).
struct FeatureGrain {
  Point from;  // the axis of the rectangle that represents it
  Point to;
  std::int64_t doubled_area = 0;  // cells squared; negative if it was a hole
  std::uint32_t row = 0;          // row of the feature
  Level born = 0;
  std::uint8_t is_covered = 0;  // see Grain: 1 if other features cover the place before and after
  std::uint16_t unused = 0;     // instead of padding, so that equal grains are equal bytes

  double area() const { return static_cast<double>(doubled_area) / 2; }
  Strip strip() const { return strip_of({from, to}, area()); }
  /// A box around the rectangle, with some margin so that it is cheap to compute: it is needed
  /// often.
  Box box() const;
};

// The rectangle extends beyond its axis by no more than the width of a square of its area.
inline Box FeatureGrain::box() const {
  const auto reach = static_cast<std::int64_t>(std::sqrt(std::abs(area()))) + 2;
  const auto cell = [](std::int64_t v) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, kGridMin, kGridMax));
  };
  return {cell(std::min(from.x, to.x) - reach), cell(std::min(from.y, to.y) - reach),
          cell(std::max(from.x, to.x) + reach), cell(std::max(from.y, to.y) + reach)};
}

/// Sorts grains for the index: those born in the same octave and near each other on the map are
/// near each other in the array.
std::uint64_t order_key(const FeatureGrain& grain);

/// Thread-safety: immutable, any number of threads may read.
class GrainIndex {
 public:
  GrainIndex() = default;
  explicit GrainIndex(StoredArray<FeatureGrain> grains);

  /// The levels, from the first to the last, at which grains were born.
  struct Births {
    Level first = 0;
    Level last = kLastLevel;

    bool is_empty() const { return first > last; }
    bool contains(std::uint32_t level) const { return first <= level && level <= last; }
  };

  /// Calls visit(grain) for every grain of these births whose rectangle may intersect the box.
  template <typename Visit>
  void visit(const Box& box, Births births, const Visit& visit) const {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (!blocks_[b].meets(box, births)) continue;
      const std::size_t end = std::min(grains_.size(), (b + 1) * kBlock);
      for (std::size_t i = b * kBlock; i < end; ++i) {
        if (births.contains(grains_[i].born) && grains_[i].box().intersects(box)) visit(grains_[i]);
      }
    }
  }

  /// The number of grains that visit() examines: at least as many as it visits.
  std::size_t count_near(const Box& box, Births births) const;

  std::span<const FeatureGrain> grains() const { return grains_; }
  std::size_t memory() const { return grains_.memory() + blocks_.capacity() * sizeof(Block); }

 private:
  static constexpr std::size_t kBlock = 64;
  struct Block {
    Box box;
    std::uint32_t min_born = kNeverDies;
    std::uint32_t max_born = 0;

    bool meets(const Box& other, Births births) const {
      return min_born <= births.last && max_born >= births.first && box.intersects(other);
    }
  };

  StoredArray<FeatureGrain> grains_;
  std::vector<Block> blocks_;
};

}  // namespace trapeze
