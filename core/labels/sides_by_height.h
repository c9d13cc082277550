// The sides of a boundary, indexed by height.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"

namespace trapeze {

/// Finds the sides that extend to a height, or between two heights, among numbered sides. Any
/// number of threads may read.
class SidesByHeight {
 public:
  struct Heights {
    double low = 0;
    double high = 0;
  };
  static constexpr Heights between(Point a, Point b) {
    return {static_cast<double>(std::min(a.y, b.y)), static_cast<double>(std::max(a.y, b.y))};
  }

  /// Takes the sides 0 to `count` - 1, as far as they extend between `top` and `bottom`.
  /// heights_of(side) is called several times and must return the same Heights each time.
  template <typename HeightsOf>
  void sort(std::size_t count, double top, double bottom, const HeightsOf& heights_of) {
    top_ = top;
    const double height = bottom - top;
    double sum = 0;
    for (std::uint32_t side = 0; side < count; ++side) {
      const Heights heights = heights_of(side);
      sum += std::min(heights.high - heights.low, height);
    }
    row_count_ = row_count(count, sum, height);
    row_height_ = std::max(height / static_cast<double>(row_count_), 1e-3);
    begins_.assign(row_count_ + 1, 0);
    const auto for_each_row_of_sides = [&](const auto& visit) {
      for (std::uint32_t side = 0; side < count; ++side) {
        const Heights heights = heights_of(side);
        if (heights.high < top || heights.low > bottom) continue;
        const std::size_t last = row_at(heights.high);
        for (std::size_t row = row_at(heights.low); row <= last; ++row) visit(row, side);
      }
    };
    for_each_row_of_sides([this](std::size_t row, std::uint32_t) { ++begins_[row + 1]; });
    for (std::size_t row = 0; row < row_count_; ++row) begins_[row + 1] += begins_[row];
    sides_.resize(begins_.back());
    // Each row is filled from its begin, which moves to its end; then all are moved back.
    for_each_row_of_sides(
        [this](std::size_t row, std::uint32_t side) { sides_[begins_[row]++] = side; });
    std::shift_right(begins_.begin(), begins_.end(), 1);
    begins_.front() = 0;
  }

  /// All sides that extend to that height, and possibly others; in order of their numbers.
  std::span<const std::uint32_t> at(double y) const { return row(row_at(y)); }

  /// Calls visit(side) once for all sides that extend between these heights, and possibly for
  /// others. `heights_of` is the same as in sort().
  template <typename HeightsOf, typename Visit>
  void visit_between(double top, double bottom, const HeightsOf& heights_of,
                     const Visit& visit) const {
    const std::size_t first = row_at(top);
    const std::size_t last = row_at(bottom);
    for (std::size_t i = first; i <= last; ++i) {
      for (const std::uint32_t side : row(i)) {
        if (std::max(row_at(heights_of(side).low), first) == i) visit(side);
      }
    }
  }

 private:
  /// How many rows of equal height to sort sides into. `heights` is the sum of their heights, each
  /// at most `height`. Where most sides are high, more rows would need much memory and save
  /// nothing.
  static std::size_t row_count(std::size_t sides, double heights, double height) {
    constexpr std::size_t kSidesPerRow = 4;
    constexpr std::size_t kMostRows = 4096;
    constexpr double kRowsPerSide = 16;  // on average, at most
    const std::size_t rows = std::clamp<std::size_t>(sides / kSidesPerRow, 1, kMostRows);
    if (heights <= 0) return rows;
    const double most = kRowsPerSide * static_cast<double>(sides) * height / heights;
    return static_cast<std::size_t>(std::clamp(most, 1.0, static_cast<double>(rows)));
  }

  std::size_t row_at(double y) const {
    const double row =
        std::clamp((y - top_) / row_height_, 0.0, static_cast<double>(row_count_ - 1));
    return static_cast<std::size_t>(row);
  }
  std::span<const std::uint32_t> row(std::size_t i) const {
    return std::span(sides_).subspan(begins_[i], begins_[i + 1] - begins_[i]);
  }

  double top_ = 0;
  double row_height_ = 1;
  std::size_t row_count_ = 1;
  std::vector<std::uint32_t> begins_ = {0, 0};  // by row, in sides_; and the end of the last
  std::vector<std::uint32_t> sides_;            // row by row
};

}  // namespace trapeze
