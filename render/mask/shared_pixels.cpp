#include "render/mask/shared_pixels.h"

#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace trapeze {
namespace {

constexpr int kPoints = 64;  // of a pixel
constexpr auto kRoundEnd = static_cast<float>(M_PI / 4);
// The rows of the points, by column: found by exchanging rows until the share of the points in any
// half-plane was off by no more than 1/32.
constexpr std::array<int, kPoints> kRows = {
    17, 48, 2,  32, 60, 26, 39, 47, 9,  58, 21, 33, 13, 43, 7,  56, 27, 49, 0,  20, 34, 42,
    61, 10, 24, 51, 16, 59, 35, 4,  44, 8,  31, 19, 53, 25, 12, 37, 45, 62, 54, 1,  23, 14,
    38, 55, 29, 6,  50, 41, 22, 15, 57, 3,  36, 11, 28, 46, 63, 52, 18, 30, 40, 5};

constexpr double coordinate(int i) {
  return (i + 0.5) / kPoints - 0.5;
}

}  // namespace

HalfPlanes::HalfPlanes() : masks_(kDirections * kOffsets) {
  for (unsigned direction = 0; direction < kDirections; ++direction) {
    const double angle = 2 * M_PI * direction / kDirections;
    const double dx = std::cos(angle);
    const double dy = std::sin(angle);
    std::uint64_t* const masks = masks_.data() + direction * kOffsets;
    for (int point = 0; point < kPoints; ++point) {
      const double along =
          coordinate(point) * dx + coordinate(kRows[static_cast<std::size_t>(point)]) * dy;
      for (std::size_t i = 0; i < kOffsets; ++i) {
        const double offset = (static_cast<double>(i) - kMostOffset) / kSteps;
        if (along <= offset) masks[i] |= std::uint64_t{1} << point;
      }
    }
  }
}

const HalfPlanes& HalfPlanes::table() {
  static const HalfPlanes table;
  return table;
}

unsigned HalfPlanes::direction_of(double dx, double dy) {
  double along = std::abs(dx);
  double beside = std::abs(dy);
  const bool is_steep = beside > along;
  if (is_steep) std::swap(along, beside);
  // The angle within an eighth of a turn, which is 1, off by less than a quarter of a degree.
  const double slope = beside / along;
  const double eighth = slope + 0.3473 * slope * (1 - slope);
  auto direction = static_cast<unsigned>(eighth * (kDirections / 8) + 0.5);
  if (is_steep) direction = kRightAngle - direction;
  if (dx < 0) direction = kDirections / 2 - direction;
  if (dy < 0) direction = kDirections - direction;
  return direction % kDirections;
}

/// The points that are not beyond the ends, for a position along the line.
std::uint64_t SampledLine::end_samples(const HalfPlanes& half_planes, float along) const {
  // As much longer as makes the area that of a round end.
  const float end = has_round_ends ? kRoundEnd * half : 0;
  const std::uint64_t samples = half_planes.within(direction, length + end - along) &
                                ~half_planes.within(direction, -end - along);
  if (!has_round_ends || half <= 1 || (along >= 0 && along <= length)) return samples;
  // Round ends of wide lines are not square: a tangent.
  const float off_end = along < 0 ? 0 : length;
  const float off_x = -x - off_end * dx;
  const float off_y = -y - off_end * dy;
  const float off = std::sqrt(off_x * off_x + off_y * off_y);
  return samples & half_planes.within(HalfPlanes::direction_of(off_x, off_y), half - off);
}

void SharedPixels::begin(std::size_t pixels) {
  if (pixels != known_.size() || !is_clean_) known_.assign(pixels, 0);
  is_clean_ = false;
  shared_.clear();
}

void SharedPixels::forget(std::size_t begin, std::size_t end) {
  std::fill(known_.data() + begin, known_.data() + end, 0);
}

void SharedPixels::finish() {
  is_clean_ = true;
}

// One point less than are covered, as the samples are off by about one, and where they are too
// many, they would count: a pixel shows the greater of this and the greatest value of a line.
std::uint8_t SharedPixels::value_of(const Shared& pixel) {
  const int points = std::popcount(pixel.samples);
  const int covered = points == kPoints ? kPoints : std::max(points - 1, 0);
  return static_cast<std::uint8_t>((covered * pixel.ink + kPoints / 2) / kPoints);
}

}  // namespace trapeze
