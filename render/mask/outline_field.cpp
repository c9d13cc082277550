#include "render/mask/outline_field.h"

#include <cmath>
#include <cstdlib>
#include <limits>
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
  first_of_round_ = 0;
  cell_of_.assign(pixels, kNone);
  nearest_.assign(pixels, kNone);
  squared_.assign(pixels, std::numeric_limits<float>::infinity());
  waiting_.clear();
  nearer_.clear();
  states_.assign(pixels, 0);
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
  std::uint32_t& number = cell_of_[place_of(column, row)];
  const CellPoint first = in_cell(from);
  if (number == kNone || number < first_of_round_) {
    Cell cell{static_cast<std::uint16_t>(column), static_cast<std::uint16_t>(row), {}, 0};
    // What earlier rounds added is as near as it was.
    if (number == kNone) {
      cell.outermost.fill(first);
    } else {
      cell.outermost = cells_[number].outermost;
    }
    number = static_cast<std::uint32_t>(cells_.size());
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

// From the centre of a pixel to the pixel that the cell is of.
float OutlineField::least_squared_distance(const Cell& cell, int column, int row) {
  const float x = std::max(static_cast<float>(std::abs(column - cell.column)) - 0.5f, 0.0f);
  const float y = std::max(static_cast<float>(std::abs(row - cell.row)) - 0.5f, 0.0f);
  return x * x + y * y;
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
  float least = std::numeric_limits<float>::infinity();
  for (const CellPoint point : cell.outermost) {
    if (point != before) least = std::min(least, to_side(before, point));
    before = point;
  }
  if (std::isinf(least)) least = to_side(before, before);
  return least * static_cast<float>(1 / (kParts * kParts));
}

// If the cell is nearer to the pixel than the nearest one so far, it replaces that one, and the
// pixel's neighbours have to be tried.
void OutlineField::pull(std::uint32_t number, int column, int row) {
  const std::size_t place = place_of(column, row);
  if (number == nearest_[place]) return;
  ++steps_;
  const Cell& cell = cells_[number];
  const float nearest = std::min(squared_[place], most_squared_);
  if (least_squared_distance(cell, column, row) >= nearest) return;
  const float squared = squared_distance(cell, column, row);
  if (squared >= nearest) return;
  nearest_[place] = number;
  squared_[place] = squared;
  const Pixel pixel{static_cast<std::uint16_t>(column), static_cast<std::uint16_t>(row)};
  if ((states_[place] & kIsWaiting) == 0) waiting_.push_back(pixel);
  if ((states_[place] & kIsNearer) == 0) nearer_.push_back(pixel);
  states_[place] = kIsWaiting | kIsNearer;
}

std::size_t OutlineField::memory() const {
  return cells_.capacity() * sizeof(Cell) +
         (cell_of_.capacity() + nearest_.capacity()) * sizeof(std::uint32_t) +
         squared_.capacity() * sizeof(float) +
         (waiting_.capacity() + next_waiting_.capacity() + nearer_.capacity()) * sizeof(Pixel) +
         states_.capacity();
}

}  // namespace trapeze
