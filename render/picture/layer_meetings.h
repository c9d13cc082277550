// How the layers of a picture lie in relation to each other within pixels that several of them
// cover in part: side by side, as land and water along a coast do, or one on the other.
//
// That is told by the pixels around: where one layer covers more of them the less the other does,
// they lie side by side; where both cover more or less together, one lies on the other. So it is
// exact where two layers share a border, whatever its shape, and for dust as for polygons.
#pragma once

#include <array>
#include <cstddef>
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
  /// The values of the rows of a mask around one, pixel by pixel.
  class RowsAround {
   public:
    void begin(const Mask& mask);
    /// Then those of the row, the one above it and the one below it, as far as there are such, may
    /// be asked for.
    void move_to(int row);
    const std::uint8_t* row(int row) const { return values_.data() + slot_of(row) * stride_; }

   private:
    static constexpr std::size_t kRows = 3;
    static std::size_t slot_of(int row) { return static_cast<std::size_t>(row) % kRows; }

    const Mask* mask_ = nullptr;
    std::size_t stride_ = 0;
    std::array<int, kRows> rows_{};  // that the slots have
    std::vector<std::uint8_t> values_;
  };

  const Mask* cover_of(const PaintedLayer& layer);
  void find_contested(const Mask& below, const Mask& above);
  void meet(double tolerance, std::vector<Meeting>& meetings);
  double correlation_around(int column, int row) const;
  void add_to_union(const Mask& below, const Mask& above, std::span<const Meeting> meetings);

  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint64_t> partial_below_;  // a bit for each pixel of a row
  std::vector<std::uint64_t> partial_above_;
  std::vector<std::uint32_t> contested_;  // row * width + column
  RowsAround below_;
  RowsAround above_;
  Mask sum_;    // of the classes of a layer
  Mask union_;  // of the layers so far, where it is not that of a mask
  Mask next_;   // what sum_ or union_ becomes
  std::vector<std::vector<Meeting>> meetings_;  // by layer
};

}  // namespace trapeze
