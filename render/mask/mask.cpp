#include "render/mask/mask.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

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

}  // namespace

View View::of_tile(const TileId& tile, int scale) {
  View view;
  view.origin_x = tile.origin_x();
  view.origin_y = tile.origin_y();
  view.width = view.height = kTilePixels * scale;
  view.cells_per_pixel = static_cast<double>(tile.side()) / view.width;
  return view;
}

Box View::box() const {
  const auto min_x = static_cast<double>(origin_x);
  const auto min_y = static_cast<double>(origin_y);
  const double max_x = min_x + std::ceil(width * cells_per_pixel);
  const double max_y = min_y + std::ceil(height * cells_per_pixel);
  if (is_off_grid(min_x, max_x) || is_off_grid(min_y, max_y)) return Box{};
  return Box{clamp_to_grid(min_x), clamp_to_grid(min_y), clamp_to_grid(max_x),
             clamp_to_grid(max_y)};
}

void View::check() const {
  if (width < 1 || height < 1 || width > kMaxPicturePixels || height > kMaxPicturePixels) {
    throw std::invalid_argument("a picture is 1 to " + std::to_string(kMaxPicturePixels) +
                                " pixels wide and high, not " + std::to_string(width) + " x " +
                                std::to_string(height));
  }
  if (!(cells_per_pixel > 0) || !std::isfinite(cells_per_pixel)) {
    throw std::invalid_argument("cells_per_pixel must be positive and finite");
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
    // Most runs are short: what is written beyond one is overwritten by the next.
    for (; begin < run.end; begin += kCopyRoom) std::memset(values + begin, run.value, kCopyRoom);
    begin = run.end;
  }
}

bool Mask::is_all(std::uint8_t value) const {
  return used_ == row_end_.size() &&
         std::all_of(runs_.begin(), runs_.begin() + static_cast<std::ptrdiff_t>(used_),
                     [value](const MaskRun& run) { return run.value == value; });
}

bool operator==(const Mask& a, const Mask& b) {
  return a.width_ == b.width_ && a.height_ == b.height_ && a.row_end_ == b.row_end_ &&
         std::ranges::equal(std::span(a.runs_).first(a.used_), std::span(b.runs_).first(b.used_));
}

}  // namespace trapeze
