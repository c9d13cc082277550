// The truth for comparison with pictures: the unsimplified outlines of a layer, sampled at 16 x 16
// points a pixel. Shares no code with core's trapezoids or render's areas.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/rings.h"
#include "core/layer/layer.h"
#include "render/mask/mask.h"

namespace trapeze::testing {

constexpr int kSamplesPerSide = 16;  // of a pixel

/// Thread-safety: immutable after construction.
class TrueOutlines {
 public:
  TrueOutlines() = default;
  explicit TrueOutlines(const Layer& layer);

  /// Adds the next feature; the inside is even-odd over its rings.
  void add(const Rings& rings);

  /// The share of each pixel's sample points that lie inside, summed over features, at most 1. A
  /// point on the boundary is inside if the polygon is right of it or below. The view is at most
  /// 4095 pixels wide and high.
  Mask draw(const View& view) const;

  const std::vector<Point>& points() const { return points_; }

 private:
  struct Feature {
    Box box;
    std::size_t rings_end;  // index into ring_ends_
  };

  std::vector<Point> points_;  // of all rings of all features
  std::vector<std::size_t> ring_ends_;
  std::vector<Feature> features_;
};

}  // namespace trapeze::testing
