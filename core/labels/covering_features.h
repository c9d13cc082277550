// Features that lie over others, as the search for anchors of labels needs them: one that covers
// thousands of small ones is prepared once, and only its sides near each of them are examined.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "core/grid/digest.h"
#include "core/grid/grid.h"
#include "core/grid/rings.h"
#include "core/labels/sides_by_height.h"
#include "core/layer/layer.h"

namespace trapeze {

/// A feature that covers others. Immutable; any number of threads may read.
class CoveringFeature {
 public:
  explicit CoveringFeature(Rings rings);

  /// The bounding box of all rings.
  const Box& box() const { return box_; }
  /// The area of the largest ring, in square cells.
  double area() const { return area_; }
  /// Of its rings, see digest_of().
  const Digest& digest() const { return digest_; }

  /// Calls visit(a, b) once for all sides that extend between these heights, and possibly for
  /// others.
  template <typename Visit>
  void visit_sides(double top, double bottom, const Visit& visit) const {
    by_height_.visit_between(
        top, bottom, [this](std::uint32_t side) { return heights_of(side); },
        [&](std::uint32_t side) { visit(rings_.points[side], rings_.points[next_[side]]); });
  }

  std::size_t point_count() const { return rings_.points.size(); }

 private:
  SidesByHeight::Heights heights_of(std::uint32_t side) const;

  Rings rings_;
  std::vector<std::uint32_t> next_;  // the end of the side that begins at each point
  SidesByHeight by_height_;
  Box box_;
  double area_ = 0;
  Digest digest_;
};

/// Prepares covering features of a layer when they are first needed, and keeps those needed lately.
/// Any number of threads may use it at the same time.
class CoveringFeatures {
 public:
  /// Keeps a reference to the layer.
  explicit CoveringFeatures(const Layer& layer) : layer_(layer) {}

  /// The feature of that row, which must not be removed.
  std::shared_ptr<const CoveringFeature> at(std::uint32_t row);

 private:
  using ByRow = std::unordered_map<std::uint32_t, std::shared_ptr<const CoveringFeature>>;

  std::shared_ptr<const CoveringFeature> find(std::uint32_t row);
  // The caller holds the lock.
  void keep(std::uint32_t row, const std::shared_ptr<const CoveringFeature>& feature);

  const Layer& layer_;
  std::mutex mutex_;
  // When `recent_` has too many points, it takes the place of `older_`.
  ByRow recent_;
  ByRow older_;
  std::size_t recent_points_ = 0;
};

}  // namespace trapeze
