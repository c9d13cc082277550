// How the layers of a picture lie in relation to each other within pixels that several of them
// cover in part: side by side, as land and water along a coast do, or one on the other.
//
// That is told by the pixels around: where one layer covers more of them the less the other does,
// they lie side by side; where both cover more or less together, one lies on the other. So it is
// exact where two layers share a border, whatever its shape, and for dust as for polygons.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/picture/painted_layer.h"

namespace trapeze {

/// Use for one picture after the other; holds what it found until the next one. One thread at a
/// time.
class LayerMeetings {
 public:
  /// Sets the meetings of each layer with those below it, the first one lowest. `tolerances` are by
  /// layer: how far its boundary may be from the true one, in pixels of the picture. The masks are
  /// width x height. The layers look at memory of this object.
  void find(std::span<PaintedLayer> layers, std::span<const double> tolerances, int width,
            int height);

 private:
  // Values of masks.
  using Values = std::span<const std::uint8_t>;

  Values cover_of(const PaintedLayer& layer);
  void find_contested(Values below, Values above);
  void meet(Values below, Values above, double tolerance, std::vector<Meeting>& meetings);
  double correlation_around(std::uint32_t pixel, Values below, Values above) const;
  void add_to_union(Values below, Values above, std::span<const Meeting> meetings);

  int width_ = 0;
  int height_ = 0;
  std::size_t pixels_ = 0;
  std::vector<std::uint64_t> partial_;  // a bit for each pixel
  std::vector<std::uint32_t> contested_;
  std::vector<std::uint8_t> sum_;    // of the classes of a layer
  std::vector<std::uint8_t> union_;  // of the layers so far, where it is not that of a mask
  std::vector<std::uint8_t> next_union_;
  std::vector<std::vector<Meeting>> meetings_;  // by layer
};

}  // namespace trapeze
