// The distance of every pixel from the nearest of many lines, at a cost that does not grow with the
// width of the lines.
//
// Of each pixel that lines pass through, their outermost points in eight directions are kept. So a
// cell with one line in it has the ends of the piece within the cell, and the distance from it is
// exact; from a cell with many lines it is right within a tenth of a pixel, at two pixels and
// further away. The nearest cell spreads from pixel to pixel, row by row, down and up again.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/grid/cancellation.h"

namespace trapeze {

/// A place in a picture, in pixels.
struct PicturePlace {
  double x;
  double y;
};

/// Working memory for one picture after the other. One thread at a time may use it.
class OutlineField {
 public:
  /// Begins anew: a picture of width x height pixels, and lines that nothing further than `reach`
  /// pixels from them asks for.
  void begin(int width, int height, double reach);

  /// Adds a line. share_at(part), for a part of its length from 0 to 1, is how much of the line is
  /// there, from 0 to 1: where lines share a pixel, the greatest share counts.
  template <typename ShareAt>
  void add(PicturePlace from, PicturePlace to, const ShareAt& share_at);

  /// Finds the nearest lines, when all have been added. Throws Cancelled.
  void spread(const Cancellation* cancellation);

  /// Of a pixel of the picture, after spread().
  struct Nearest {
    float distance;  // of its centre, in pixels; beyond the reach if there is no line within it
    float share;     // of the line there
  };
  Nearest nearest(int column, int row) const;

  /// Cells that lines passed through, each time, and cells that were looked at in search of the
  /// nearest one: the work that was done since begin().
  std::uint64_t steps() const { return steps_; }
  /// Bytes of working memory.
  std::size_t memory() const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr int kDirections = 8;
  static constexpr double kParts = 255;  // of a pixel, in which points are kept

  struct CellPoint {
    std::uint8_t x;
    std::uint8_t y;

    friend bool operator==(CellPoint, CellPoint) = default;
  };
  struct Cell {
    std::uint16_t column;
    std::uint16_t row;
    std::array<CellPoint, kDirections> outermost;
    std::uint8_t share;
  };
  // Of a line, as far as it crosses the grid: parts of its length.
  struct Crossing {
    double begin;
    double end;
  };

  Crossing crossing(PicturePlace from, PicturePlace to) const;
  void add_piece(int column, int row, PicturePlace from, PicturePlace to, float share);
  static void include(Cell& cell, CellPoint point);
  static float squared_distance(const Cell& cell, int column, int row);
  void pull(std::size_t place, int column, int row, std::size_t from);
  void spread_row(int row, int previous_row);
  std::size_t place_of(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  // The grid: the picture, and a margin around it.
  int margin_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  float most_squared_ = 0;              // distance that is of interest
  std::vector<Cell> cells_;             // that lines pass through
  std::vector<std::uint32_t> nearest_;  // cell, by pixel
  std::vector<float> squared_;          // distance from it, by pixel
  std::uint64_t steps_ = 0;
};

template <typename ShareAt>
void OutlineField::add(PicturePlace from, PicturePlace to, const ShareAt& share_at) {
  from = {from.x + margin_, from.y + margin_};
  to = {to.x + margin_, to.y + margin_};
  const auto [begin, end] = crossing(from, to);
  if (!(begin <= end)) return;
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const auto place_at = [&](double part) {
    return PicturePlace{from.x + dx * part, from.y + dy * part};
  };
  PicturePlace here = place_at(begin);
  int column = std::min(static_cast<int>(here.x), columns_ - 1);
  int row = std::min(static_cast<int>(here.y), rows_ - 1);
  // The parts at which the line leaves the column and the row.
  const auto part_at = [](double border, double start, double along) {
    return along == 0 ? 2.0 : (border - start) / along;
  };
  for (double part = begin; column >= 0 && column < columns_ && row >= 0 && row < rows_;) {
    const double leaves_column = part_at(column + (dx > 0 ? 1 : 0), from.x, dx);
    const double leaves_row = part_at(row + (dy > 0 ? 1 : 0), from.y, dy);
    const double next = std::max(part, std::min({leaves_column, leaves_row, end}));
    const PicturePlace there = place_at(next);
    add_piece(column, row, here, there, share_at((part + next) / 2));
    if (next >= end) return;
    if (leaves_column <= leaves_row) {
      column += dx > 0 ? 1 : -1;
    } else {
      row += dy > 0 ? 1 : -1;
    }
    part = next;
    here = there;
  }
}

}  // namespace trapeze
