#include "render/mask/mask.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "core/grid/plate_carree.h"

namespace trapeze {
namespace {

constexpr std::int64_t kMaxOrigin = std::int64_t{1} << 40;

std::int32_t clamp_to_grid(double cells) {
  return static_cast<std::int32_t>(
      std::clamp(cells, static_cast<double>(kGridMin), static_cast<double>(kGridMax)));
}

bool is_off_grid(double from, double to) {
  return to < kGridMin || from > kGridMax;
}

/// The sides of the cells that a picture may show.
struct Sides {
  double west;
  double north;
  double east;
  double south;
};

Sides sides_of(const View& view) {
  const auto x = static_cast<double>(view.origin_x);
  const auto y = static_cast<double>(view.origin_y);
  const double rows = view.cells_per_row();
  return {x, y + std::floor(view.first_row * rows),
          x + std::ceil(view.width * view.cells_per_pixel),
          y + std::ceil((view.first_row + view.height) * rows)};
}

/// For a picture in plate carree: all grid cells that it may show, although points are rounded to
/// cells of either kind.
Sides in_mercator(const Sides& sides) {
  return {sides.west, std::floor(mercator_from_plate_carree(sides.north - 1)), sides.east,
          std::ceil(mercator_from_plate_carree(sides.south + 1))};
}

}  // namespace

View View::of_tile(const TileId& tile, int scale) {
  View view;
  view.origin_x = tile.origin_x();
  view.origin_y = tile.origin_y();
  view.width = view.height = kTilePixels * scale;
  view.cells_per_pixel = static_cast<double>(tile.side()) / view.width;
  return view;
}

View View::band(int row, int rows) const {
  View band = *this;
  band.first_row += row;
  band.height = rows;
  return band;
}

double View::longer_side() const {
  const double longer = cells_per_pixel * (stretch > 1 ? stretch : 1);
  if (projection != Projection::plate_carree) return longer;
  const Box shown = box();
  if (shown.is_empty()) return longer;
  const auto farthest = static_cast<double>(std::max(std::abs(shown.min_y), std::abs(shown.max_y)));
  return std::max(cells_per_pixel, cells_per_row() * mercator_stretch(farthest));
}

double View::side_at(double y) const {
  const double side = cells_per_pixel * std::sqrt(stretch);
  return projection == Projection::plate_carree ? side * std::sqrt(mercator_stretch(y)) : side;
}

Box View::box() const {
  Sides sides = sides_of(*this);
  if (projection == Projection::plate_carree) sides = in_mercator(sides);
  if (is_off_grid(sides.west, sides.east) || is_off_grid(sides.north, sides.south)) return Box{};
  return Box{clamp_to_grid(sides.west), clamp_to_grid(sides.north), clamp_to_grid(sides.east),
             clamp_to_grid(sides.south)};
}

Box View::box_around(double pixels) const {
  if (box().is_empty()) return {};
  const int more = static_cast<int>(std::ceil(pixels));
  View around = *this;
  around.origin_x -= static_cast<std::int64_t>(std::ceil(more * cells_per_pixel));
  around.width += 2 * more + 1;
  around.first_row -= more;
  around.height += 2 * more;
  return around.box();
}

double View::row_from_y(double y) const {
  const bool is_projected = projection == Projection::plate_carree;
  const double cell = is_projected ? plate_carree_from_mercator(y) : y;
  return (cell - static_cast<double>(origin_y)) / cells_per_row() - first_row;
}

double View::y_from_row(double row) const {
  const double cell = static_cast<double>(origin_y) + (first_row + row) * cells_per_row();
  return projection == Projection::plate_carree ? mercator_from_plate_carree(cell) : cell;
}

bool View::is_on_world() const {
  const Sides sides = sides_of(*this);
  const bool is_projected = projection == Projection::plate_carree;
  const double end = is_projected ? plate_carree_from_mercator(kGridMax) : kGridMax;
  return sides.west >= kGridMin && sides.north >= -end && sides.east <= kGridMax &&
         sides.south <= end;
}

void View::check() const {
  if (width < 1 || height < 1 || width > kMaxPicturePixels || height > kMaxPicturePixels) {
    throw std::invalid_argument("a picture is 1 to " + std::to_string(kMaxPicturePixels) +
                                " pixels wide and high, not " + std::to_string(width) + " x " +
                                std::to_string(height));
  }
  if (!(shorter_side() > 0) || !std::isfinite(longer_side())) {
    throw std::invalid_argument("the sides of a pixel must be positive and finite");
  }
  if (std::max(std::abs(origin_x), std::abs(origin_y)) > kMaxOrigin) {
    throw std::invalid_argument("the view lies too far off the world");
  }
}

Mask::Mask(int width, int height, std::uint8_t value) {
  begin(width, height);
  for (int row = 0; row < height; ++row) {
    append(static_cast<std::size_t>(width), value);
    end_row();
  }
}

void Mask::begin(int width, int height) {
  width_ = width;
  height_ = height;
  used_ = row_begin_ = 0;
  row_end_.clear();
  make_room_for_row();
}

void Mask::make_room_for_row() {
  const std::size_t least = used_ + static_cast<std::size_t>(width_);
  if (runs_.size() < least) runs_.resize(std::max(least, 2 * runs_.size()));
}

void Mask::end_row() {
  row_end_.push_back(static_cast<std::uint32_t>(used_));
  row_begin_ = used_;
  if (row_end_.size() < static_cast<std::size_t>(height_)) make_room_for_row();
}

std::uint8_t Mask::at(int column, int row) const {
  const auto runs = this->row(row);
  return std::ranges::upper_bound(runs, column, {}, &MaskRun::end)->value;
}

void Mask::copy_row(int row, std::uint8_t* values) const {
  std::size_t begin = 0;
  for (const MaskRun& run : this->row(row)) {
    // Most runs are short: excess values are overwritten by the next run.
    for (; begin < run.end; begin += kCopyRoom) std::memset(values + begin, run.value, kCopyRoom);
    begin = run.end;
  }
}

bool Mask::is_all(std::uint8_t value) const {
  return used_ == row_end_.size() &&
         std::all_of(runs_.begin(), runs_.begin() + static_cast<std::ptrdiff_t>(used_),
                     [value](const MaskRun& run) { return run.value == value; });
}

namespace {

template <typename Combine>
Mask combined(const Mask& a, const Mask& b, const Combine& combine) {
  Mask made;
  made.begin(a.width(), a.height());
  for (int row = 0; row < a.height(); ++row) {
    for_each_run_of_both(a.row(row), b.row(row),
                         [&](std::size_t end, std::uint8_t of_a, std::uint8_t of_b) {
                           made.append(end, combine(of_a, of_b));
                         });
    made.end_row();
  }
  return made;
}

}  // namespace

Mask sum_of(const Mask& a, const Mask& b) {
  return combined(a, b, [](std::uint8_t of_a, std::uint8_t of_b) {
    return static_cast<std::uint8_t>(std::min(of_a + of_b, 255));
  });
}

Mask greater_of(const Mask& a, const Mask& b) {
  return combined(a, b, [](std::uint8_t of_a, std::uint8_t of_b) { return std::max(of_a, of_b); });
}

bool operator==(const Mask& a, const Mask& b) {
  return a.width_ == b.width_ && a.height_ == b.height_ && a.row_end_ == b.row_end_ &&
         std::ranges::equal(std::span(a.runs_).first(a.used_), std::span(b.runs_).first(b.used_));
}

}  // namespace trapeze
