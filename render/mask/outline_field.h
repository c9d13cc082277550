// The distance of every pixel from the nearest of many lines, at a cost that does not grow with the
// width of the lines.
//
// For each pixel crossed by lines, the outermost points of the lines in eight directions are
// stored. If a cell contains a single line, these are the ends of the piece within the cell, and
// distances from it are exact; distances from a cell with many lines have an error of at most a
// tenth of a pixel, from a distance of two pixels on. The nearest cell is propagated from pixel to
// pixel, as far as it is the nearest one.
//
// Lines can be added in rounds, the most important first: each round finds the pixels to which its
// lines are nearer than all earlier ones, and visits no others.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
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
  /// there, from 0 to 1: if lines of a round share a pixel, the greatest share counts.
  template <typename ShareAt>
  void add(PicturePlace from, PicturePlace to, const ShareAt& share_at);

  /// The nearest line of a pixel of the picture.
  struct Nearest {
    float distance;  // from its centre, in pixels
    float share;     // of the line there
  };
  /// Ends a round: finds the pixels to which lines added in this round are nearer than all earlier
  /// ones. Calls on_nearer(column, row, nearest) for each of them that lies in the picture and
  /// within the reach. Throws Cancelled.
  template <typename OnNearer>
  void spread(const Cancellation* cancellation, const OnNearer& on_nearer);

  /// The work done since begin(): how many cells lines have crossed, each crossing counted, and how
  /// many cells were examined to find the nearest one.
  std::uint64_t steps() const { return steps_; }
  /// Bytes of working memory.
  std::size_t memory() const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr int kDirections = 8;
  static constexpr double kParts = 255;  // of a pixel, the resolution of stored points
  static constexpr float kSharesOfOne = 255;
  static constexpr std::uint8_t kIsWaiting = 1;
  static constexpr std::uint8_t kIsNearer = 2;

  struct CellPoint {
    std::uint8_t x;
    std::uint8_t y;

    friend bool operator==(CellPoint, CellPoint) = default;
  };
  struct Cell {
    std::uint16_t column;
    std::uint16_t row;
    std::array<CellPoint, kDirections> outermost;
    std::uint8_t share;  // of the lines that its round added
  };
  // The part of a line that crosses the grid, as positions along its length.
  struct Crossing {
    double begin;
    double end;
  };

  Crossing crossing(PicturePlace from, PicturePlace to) const;
  void add_piece(int column, int row, PicturePlace from, PicturePlace to, float share);
  static void include(Cell& cell, CellPoint point);
  static float least_squared_distance(const Cell& cell, int column, int row);
  static float squared_distance(const Cell& cell, int column, int row);
  float share_of(std::uint32_t number) const {
    return static_cast<float>(cells_[number].share) / kSharesOfOne;
  }
  void pull(std::uint32_t number, int column, int row);
  std::size_t place_of(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  // The grid: the picture with a margin around it.
  int margin_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  float most_squared_ = 0;              // maximum distance of interest
  std::vector<Cell> cells_;             // crossed by lines; a later round adds new ones
  std::size_t first_of_round_ = 0;      // in cells_
  std::vector<std::uint32_t> cell_of_;  // by pixel: the last cell in it
  std::vector<std::uint32_t> nearest_;  // index of the cell, by pixel
  std::vector<float> squared_;          // squared distance from it, by pixel
  struct Pixel {
    std::uint16_t column;
    std::uint16_t row;
  };
  // In this round: pixels whose neighbours have to be tried, and all that became nearer.
  std::vector<Pixel> waiting_;
  std::vector<Pixel> next_waiting_;
  std::vector<Pixel> nearer_;
  std::vector<std::uint8_t> states_;  // by pixel: which of the two it is in
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

template <typename OnNearer>
void OutlineField::spread(const Cancellation* cancellation, const OnNearer& on_nearer) {
  CancellationCheck check(cancellation, 4096);
  const auto try_around = [&](std::uint32_t number, int column, int row) {
    const int end_column = std::min(column + 2, columns_);
    const int end_row = std::min(row + 2, rows_);
    for (int y = std::max(row - 1, 0); y < end_row; ++y) {
      for (int x = std::max(column - 1, 0); x < end_column; ++x) pull(number, x, y);
    }
  };
  // Where an earlier round had a line in the pixel, a cell may be nearer to a neighbour only.
  for (std::size_t i = first_of_round_; i < cells_.size(); ++i) {
    try_around(static_cast<std::uint32_t>(i), cells_[i].column, cells_[i].row);
  }
  first_of_round_ = cells_.size();
  while (!waiting_.empty()) {
    next_waiting_.clear();
    next_waiting_.swap(waiting_);
    for (const auto [pixel_column, pixel_row] : next_waiting_) {
      check();
      const std::size_t place = place_of(pixel_column, pixel_row);
      states_[place] = kIsNearer;
      try_around(nearest_[place], pixel_column, pixel_row);
    }
  }
  for (const auto [column, row] : nearer_) {
    const std::size_t place = place_of(column, row);
    states_[place] = 0;
    const int x = column - margin_;
    const int y = row - margin_;
    if (x < 0 || x >= columns_ - 2 * margin_ || y < 0 || y >= rows_ - 2 * margin_) continue;
    on_nearer(x, y, Nearest{std::sqrt(squared_[place]), share_of(nearest_[place])});
  }
  nearer_.clear();
}

}  // namespace trapeze
