// The distance of every pixel from the nearest of many lines, at a cost that does not grow with the
// width of the lines.
//
// For each pixel crossed by lines, the outermost points of the lines in eight directions are
// stored. If a cell contains a single line, these are the ends of the piece within the cell, and
// distances from it are exact; distances from a cell with many lines have an error of at most a
// tenth of a pixel, from a distance of two pixels on. The nearest cell is propagated from pixel to
// pixel, row by row, downwards and then upwards.
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

/// Working memory, used for one picture after the other. One thread at a time.
class OutlineField {
 public:
  /// Starts a picture of width x height pixels; pixels further than `reach` pixels from all lines
  /// are not of interest.
  void begin(int width, int height, double reach);

  /// Adds a line. share_at(part), for a position along its length from 0 to 1, is the share of ink
  /// there, from 0 to 1: if lines share a pixel, the greatest share counts.
  template <typename ShareAt>
  void add(PicturePlace from, PicturePlace to, const ShareAt& share_at);

  /// Finds the nearest lines, after all have been added. Throws Cancelled.
  void spread(const Cancellation* cancellation);

  /// The nearest line of a pixel of the picture, after spread().
  struct Nearest {
    float distance;  // from its centre, in pixels; more than the reach if no line is within it
    float share;     // of the line there
  };
  Nearest nearest(int column, int row) const;

  /// The work done since begin(): how many cells lines have crossed, each crossing counted, and how
  /// many cells were examined to find the nearest one.
  std::uint64_t steps() const { return steps_; }
  /// Bytes of working memory.
  std::size_t memory() const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr int kDirections = 8;
  static constexpr double kParts = 255;  // of a pixel, the resolution of stored points

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
  // The part of a line that crosses the grid, as positions along its length.
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

  // The grid: the picture with a margin around it.
  int margin_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  float most_squared_ = 0;              // maximum distance of interest
  std::vector<Cell> cells_;             // crossed by lines
  std::vector<std::uint32_t> nearest_;  // index of the cell, by pixel
  std::vector<float> squared_;          // squared distance from it, by pixel
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
  // The positions at which the line leaves the column and the row.
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
