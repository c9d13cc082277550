#include "render/picture/pattern.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace trapeze {
namespace {

/// The share of a segment one pixel long, centred on `place`, that is covered by bands of that
/// width. The bands repeat with `period`, and one of them is centred on 0; the segment is across
/// the bands.
double band_value(double place, double period, double width) {
  if (width >= period) return 1;
  const double half = width / 2;
  const auto overlap = [half](double distance) {
    return std::max(0.0, std::min(distance + 0.5, half) - std::max(distance - 0.5, -half));
  };
  const double distance = std::min(place, period - place);
  return std::min(1.0, overlap(distance) + overlap(period - distance));
}

constexpr double kPhases = 4294967296.0;
// Of worlds that are narrower, as they are in pictures of a few pixels, patterns are not changed.
constexpr double kLeastPeriodsOfWorld = 4 - 1e-6;

/// The nearest of 2048 sizes per octave, among which are those of tiles. The sides of windows, and
/// thus their pixels, are rounded, which must not move the patterns of neighbours.
double rounded_size(double size) {
  constexpr double kSizesPerOctave = 2048;
  return std::exp2(std::round(std::log2(size) * kSizesPerOctave) / kSizesPerOctave);
}

/// The phase of any number of periods.
std::uint32_t to_phase(double periods) {
  return static_cast<std::uint32_t>(
      static_cast<std::int64_t>((periods - std::floor(periods)) * kPhases));
}

}  // namespace

void PlacedPattern::Bands::assign(double period, double width) {
  constexpr double kStepsPerPixel = 64;
  const auto least = static_cast<std::uint32_t>(std::ceil(std::max(period, 1.0) * kStepsPerPixel));
  const auto bits = static_cast<int>(std::bit_width(least - 1));
  shift_ = 32 - bits;
  values_.resize(std::size_t{1} << bits);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(values_.size());
    values_[i] = static_cast<float>(band_value(share * period, period, width));
  }
}

void PlacedPattern::place(const Pattern& pattern, const View& view, double scale) {
  kind_ = pattern.kind;
  width_ = view.width;
  height_ = view.height;
  const double angle = pattern.angle * std::numbers::pi / 180;
  const double period = pattern.size * scale;
  // Periods per pixel; rows run southwards.
  along_x_ = std::cos(angle) / period;
  along_y_ = -std::sin(angle) / period;
  if (view.projection != Projection::plane) join_around_the_world(view, scale);
  period_ = 1 / std::sqrt(along_x_ * along_x_ + along_y_ * along_y_);
  const double band_width = kind_ == PatternKind::checker ? period / 2 : pattern.width * scale;
  band_width_ = band_width * (period_ / period);
  west_ = static_cast<double>(view.origin_x - kGridMin) / view.cells_per_pixel + 0.5;
  const double row = view.cells_per_pixel * rounded_size(view.stretch);
  row_height_ = view.cells_per_row() / row;
  north_ = static_cast<double>(view.origin_y - kGridMin) / row + view.first_row * row_height_;
  if (kind_ != PatternKind::none && kind_ != PatternKind::dots) bands_.assign(period_, band_width_);
}

// From one end of the world to the other, a whole number of periods in either direction of the
// pattern: then a translation by the world leaves it as it is, and nobody sees where the world
// begins. That number must be the same for windows side by side, although their sides, and thus
// their pixels, are rounded.
void PlacedPattern::join_around_the_world(const View& view, double scale) {
  const double world = static_cast<double>(kGridSize) / view.cells_per_pixel;
  if (std::hypot(along_x_, along_y_) * world < kLeastPeriodsOfWorld) return;
  const double rounded = rounded_size(world / scale) * scale;
  along_x_ = std::round(along_x_ * rounded) / world;
  along_y_ = std::round(along_y_ * rounded) / world;
}

void PlacedPattern::draw(int row, std::size_t begin, std::size_t end, std::uint8_t* values) const {
  switch (kind_) {
    case PatternKind::none:
      std::fill(values + begin, values + end, std::uint8_t{0});
      return;
    case PatternKind::checker:
      return draw_by(row, begin, end, values, [this](const Phases& at) {
        const float a = bands_.at(at.along);
        const float b = bands_.at(at.across);
        return a * b + (1 - a) * (1 - b);
      });
    case PatternKind::crosshatch:
      return draw_by(row, begin, end, values, [this](const Phases& at) {
        return std::max(bands_.at(at.along), bands_.at(at.across));
      });
    case PatternKind::dots:
      return draw_dots(row, begin, end, values);
    case PatternKind::hatch:
    case PatternKind::stripes:
      return draw_by(row, begin, end, values,
                     [this](const Phases& at) { return bands_.at(at.across); });
  }
}

void PlacedPattern::draw_dots(int row, std::size_t begin, std::size_t end,
                              std::uint8_t* values) const {
  // Dots smaller than a pixel become paler instead.
  const double radius = std::max(band_width_ / 2, 0.5);
  const auto most = static_cast<float>(std::min(1.0, band_width_ * band_width_));
  const auto reach = static_cast<float>(radius + 0.5);
  const auto pixels_of = static_cast<float>(period_ / kPhases);
  // A dot is centred on phase 0: a phase as a signed number is the distance from there.
  const auto from_middle = [pixels_of](Phase phase) {
    return static_cast<float>(static_cast<std::int32_t>(phase)) * pixels_of;
  };
  draw_by(row, begin, end, values, [&](const Phases& at) {
    const float along = from_middle(at.along);
    const float across = from_middle(at.across);
    const float squared = along * along + across * across;
    if (squared >= reach * reach) return 0.0f;
    return most * std::min(reach - std::sqrt(squared), 1.0f);
  });
}

// The phases of a row advance in even steps from its first pixel, wherever the columns begin.
template <typename ShareAt>
void PlacedPattern::draw_by(int row, std::size_t begin, std::size_t end, std::uint8_t* values,
                            const ShareAt& share_at) const {
  const Phases step{to_phase(along_x_), to_phase(-along_y_)};
  const auto columns = static_cast<std::uint32_t>(begin);
  Phases at = phases_at(west_, north_ + (row + 0.5) * row_height_);
  at.along += columns * step.along;
  at.across += columns * step.across;
  for (std::size_t i = begin; i < end; ++i) {
    values[i] = static_cast<std::uint8_t>(share_at(at) * 255 + 0.5f);
    at.along += step.along;
    at.across += step.across;
  }
}

PlacedPattern::Phases PlacedPattern::phases_at(double x, double y) const {
  return {to_phase(x * along_x_ + y * along_y_), to_phase(y * along_x_ - x * along_y_)};
}

}  // namespace trapeze
