#include "render/mask/outline_field.h"

#include <cmath>
#include <utility>

namespace trapeze {
namespace {

struct Direction {
  int x;
  int y;
};

// In circular order, so that successive outermost points follow the border of the area they
// enclose.
constexpr std::array<Direction, 8> kAllAround = {
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

constexpr float kSharesOfOne = 255;

}  // namespace

void OutlineField::begin(int width, int height, double reach) {
  margin_ = static_cast<int>(std::ceil(reach)) + 1;
  columns_ = width + 2 * margin_;
  rows_ = height + 2 * margin_;
  // The nearest cell may be slightly further away than the nearest point.
  const auto most = static_cast<float>(reach + 2);
  most_squared_ = most * most;
  const auto pixels = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  cells_.clear();
  nearest_.assign(pixels, kNone);
  squared_.assign(pixels, 0);
  steps_ = 0;
}

OutlineField::Crossing OutlineField::crossing(PicturePlace from, PicturePlace to) const {
  Crossing crossing{0, 1};
  const auto narrow = [&crossing](double start, double along, double size) {
    if (along == 0) {
      if (start < 0 || start > size) crossing.end = -1;
      return;
    }
    const auto [near, far] = std::minmax({-start / along, (size - start) / along});
    crossing.begin = std::max(crossing.begin, near);
    crossing.end = std::min(crossing.end, far);
  };
  narrow(from.x, to.x - from.x, columns_);
  narrow(from.y, to.y - from.y, rows_);
  return crossing;
}

void OutlineField::add_piece(int column, int row, PicturePlace from, PicturePlace to, float share) {
  ++steps_;
  const auto in_cell = [&](PicturePlace place) {
    const auto parts = [](double offset) {
      return static_cast<std::uint8_t>(std::clamp(offset, 0.0, 1.0) * kParts + 0.5);
    };
    return CellPoint{parts(place.x - column), parts(place.y - row)};
  };
  std::uint32_t& number = nearest_[place_of(column, row)];
  const CellPoint first = in_cell(from);
  if (number == kNone) {
    number = static_cast<std::uint32_t>(cells_.size());
    Cell cell{static_cast<std::uint16_t>(column), static_cast<std::uint16_t>(row), {}, 0};
    cell.outermost.fill(first);
    cells_.push_back(cell);
  }
  Cell& cell = cells_[number];
  include(cell, first);
  include(cell, in_cell(to));
  cell.share = std::max(cell.share, static_cast<std::uint8_t>(share * kSharesOfOne + 0.5f));
}

void OutlineField::include(Cell& cell, CellPoint point) {
  for (std::size_t i = 0; i < kAllAround.size(); ++i) {
    const auto [x, y] = kAllAround[i];
    CellPoint& outermost = cell.outermost[i];
    if (x * point.x + y * point.y > x * outermost.x + y * outermost.y) outermost = point;
  }
}

// From the centre of a pixel to the border around the outermost points.
float OutlineField::squared_distance(const Cell& cell, int column, int row) {
  const float x = (static_cast<float>(column - cell.column) + 0.5f) * static_cast<float>(kParts);
  const float y = (static_cast<float>(row - cell.row) + 0.5f) * static_cast<float>(kParts);
  const auto to_side = [x, y](CellPoint a, CellPoint b) {
    const auto bx = static_cast<float>(b.x - a.x);
    const auto by = static_cast<float>(b.y - a.y);
    const float px = x - static_cast<float>(a.x);
    const float py = y - static_cast<float>(a.y);
    const float length = bx * bx + by * by;
    const float part = length > 0 ? std::clamp((px * bx + py * by) / length, 0.0f, 1.0f) : 0;
    const float dx = px - part * bx;
    const float dy = py - part * by;
    return dx * dx + dy * dy;
  };
  CellPoint before = cell.outermost.back();
  float least = to_side(before, before);
  for (const CellPoint point : cell.outermost) {
    if (point != before) least = std::min(least, to_side(before, point));
    before = point;
  }
  return least * static_cast<float>(1 / (kParts * kParts));
}

void OutlineField::spread(const Cancellation* cancellation) {
  for (const Cell& cell : cells_) {
    squared_[place_of(cell.column, cell.row)] = squared_distance(cell, cell.column, cell.row);
  }
  CancellationCheck check(cancellation, 16);
  for (int row = 0; row < rows_; ++row) {
    check();
    spread_row(row, row - 1);
  }
  for (int row = rows_ - 1; row >= 0; --row) {
    check();
    spread_row(row, row + 1);
  }
}

// From the previous row, then along the row in both directions.
void OutlineField::spread_row(int row, int previous_row) {
  const bool has_previous = previous_row >= 0 && previous_row < rows_;
  for (int column = 0; column < columns_; ++column) {
    const std::size_t place = place_of(column, row);
    if (has_previous) {
      const std::size_t previous = place_of(column, previous_row);
      pull(place, column, row, previous);
      if (column > 0) pull(place, column, row, previous - 1);
      if (column + 1 < columns_) pull(place, column, row, previous + 1);
    }
    if (column > 0) pull(place, column, row, place - 1);
  }
  for (int column = columns_ - 2; column >= 0; --column) {
    const std::size_t place = place_of(column, row);
    pull(place, column, row, place + 1);
  }
}

void OutlineField::pull(std::size_t place, int column, int row, std::size_t from) {
  const std::uint32_t number = nearest_[from];
  if (number == kNone || number == nearest_[place] || squared_[from] > most_squared_) return;
  ++steps_;
  const float squared = squared_distance(cells_[number], column, row);
  if (nearest_[place] != kNone && squared >= squared_[place]) return;
  nearest_[place] = number;
  squared_[place] = squared;
}

OutlineField::Nearest OutlineField::nearest(int column, int row) const {
  const std::size_t place = place_of(column + margin_, row + margin_);
  const std::uint32_t number = nearest_[place];
  if (number == kNone) return {static_cast<float>(margin_), 0};
  return {std::sqrt(squared_[place]), static_cast<float>(cells_[number].share) / kSharesOfOne};
}

std::size_t OutlineField::memory() const {
  return cells_.capacity() * sizeof(Cell) + nearest_.capacity() * sizeof(std::uint32_t) +
         squared_.capacity() * sizeof(float);
}

}  // namespace trapeze
