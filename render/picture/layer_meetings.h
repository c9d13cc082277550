// Determines the relation of the layers of a picture within pixels that several of them partly
// cover: side by side, like land and water along a coast, or one on top of the other.
//
// The relation is derived from the surrounding pixels: if one layer covers more of them where the
// other one covers less, they are side by side; if both cover more or less together, one is on top
// of the other. So it is exact where two layers share a border, whatever its shape, both for dust
// and for polygons.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/picture/painted_layer.h"

namespace trapeze {

/// Use it for one picture after the other; results are kept until the next one. One thread at a
/// time.
class LayerMeetings {
 public:
  /// Sets the meetings of each layer with those below it, the first one lowest. `tolerances` are by
  /// layer: the maximum distance of its boundary from the true one, in pixels of the picture. The
  /// masks must be width x height. The layers then refer to memory of this object.
  void find(std::span<PaintedLayer> layers, std::span<const double> tolerances, int width,
            int height);

 private:
  /// The values of a row of a mask and its neighbouring rows, pixel by pixel.
  class RowsAround {
   public:
    void begin(const Mask& mask);
    /// Makes available the row, the one above it and the one below it, as far as they exist.
    void move_to(int row);
    const std::uint8_t* row(int row) const { return values_.data() + slot_of(row) * stride_; }

   private:
    static constexpr std::size_t kRows = 3;
    static std::size_t slot_of(int row) { return static_cast<std::size_t>(row) % kRows; }

    const Mask* mask_ = nullptr;
    std::size_t stride_ = 0;
    std::array<int, kRows> rows_{};  // rows in the slots
    std::vector<std::uint8_t> values_;
  };

  const Mask* cover_of(const PaintedLayer& layer);
  void find_contested(const Mask& below, const Mask& above);
  void meet(double tolerance, std::vector<Meeting>& meetings);
  double correlation_around(int column, int row) const;
  void add_to_union(const Mask& below, const Mask& above, std::span<const Meeting> meetings);

  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint64_t> partial_below_;  // one bit per pixel of a row
  std::vector<std::uint64_t> partial_above_;
  std::vector<std::uint32_t> contested_;  // row * width + column
  RowsAround below_;
  RowsAround above_;
  Mask sum_;                                    // of the classes of a layer
  Mask union_;                                  // of the layers so far, unless it equals a mask
  Mask next_;                                   // next value of sum_ or union_
  std::vector<std::vector<Meeting>> meetings_;  // by layer
};

}  // namespace trapeze
