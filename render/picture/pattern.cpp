#include "render/picture/pattern.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace trapeze {
namespace {

/// The share of a segment one pixel long, centred on `place`, that bands of `width` cover. The
/// bands repeat after `period`, one of them around 0; the segment is across the bands.
double band_value(double place, double period, double width) {
  if (width >= period) return 1;
  const double half = width / 2;
  const auto overlap = [half](double distance) {
    return std::max(0.0, std::min(distance + 0.5, half) - std::max(distance - 0.5, -half));
  };
  const double distance = std::min(place, period - place);
  return std::min(1.0, overlap(distance) + overlap(period - distance));
}

/// A place within a period, as a share of it in 2^-32: at the end of a period the next one begins
/// by itself.
using Phase = std::uint32_t;
constexpr double kPhases = 4294967296.0;

/// The phase of any number of periods.
Phase to_phase(double periods) {
  return static_cast<Phase>(static_cast<std::int64_t>((periods - std::floor(periods)) * kPhases));
}

/// The values of bands at all places of a period, looked up.
class Bands {
 public:
  Bands(double period, double width) {
    const auto least =
        static_cast<std::uint32_t>(std::ceil(std::max(period, 1.0) * kStepsPerPixel));
    const int bits = std::bit_width(least - 1);
    shift_ = 32 - bits;
    values_.resize(std::size_t{1} << bits);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(values_.size());
      values_[i] = static_cast<float>(band_value(share * period, period, width));
    }
  }

  float at(Phase phase) const { return values_[phase >> shift_]; }

 private:
  static constexpr double kStepsPerPixel = 64;

  int shift_ = 0;
  std::vector<float> values_;
};

/// Where a pattern lies in one picture: u runs along its direction, v across, in pixels.
struct Frame {
  const View& view;
  double period;
  double along_x;
  double along_y;
  double west;  // of the picture, from the corner of the world
  double north;

  /// Calls value_at(u, v) for every pixel.
  template <typename ValueAt>
  void draw(Mask& mask, const ValueAt& value_at) const {
    const double x = west + 0.5;
    const Phase u_step = to_phase(along_x / period);
    const Phase v_step = to_phase(-along_y / period);
    for (int row = 0; row < view.height; ++row) {
      const double y = north + row + 0.5;
      Phase u = to_phase((x * along_x + y * along_y) / period);
      Phase v = to_phase((y * along_x - x * along_y) / period);
      std::uint8_t* out = mask.row_begin(row);
      for (int column = 0; column < view.width; ++column) {
        out[column] = static_cast<std::uint8_t>(value_at(u, v) * 255 + 0.5f);
        u += u_step;
        v += v_step;
      }
    }
  }
};

void draw_dots(const Frame& frame, double width, Mask& mask) {
  // Dots smaller than a pixel are paler instead.
  const double radius = std::max(width / 2, 0.5);
  const auto share = static_cast<float>(std::min(1.0, width * width));
  const auto reach = static_cast<float>(radius + 0.5);
  const auto pixels_of = static_cast<float>(frame.period / kPhases);
  // A dot is around phase 0: as a signed number a phase is the way from there.
  const auto from_middle = [pixels_of](Phase phase) {
    return static_cast<float>(static_cast<std::int32_t>(phase)) * pixels_of;
  };
  frame.draw(mask, [&](Phase u, Phase v) {
    const float du = from_middle(u);
    const float dv = from_middle(v);
    const float squared = du * du + dv * dv;
    if (squared >= reach * reach) return 0.0f;
    return share * std::min(reach - std::sqrt(squared), 1.0f);
  });
}

}  // namespace

void draw_pattern(const Pattern& pattern, const View& view, int scale, Mask& mask) {
  mask.resize(view.width, view.height);
  const double angle = pattern.angle * std::numbers::pi / 180;
  const double width = pattern.width * scale;
  const Frame frame{view,
                    pattern.size * scale,
                    std::cos(angle),
                    -std::sin(angle),  // rows run south
                    static_cast<double>(view.origin_x - kGridMin) / view.cells_per_pixel,
                    static_cast<double>(view.origin_y - kGridMin) / view.cells_per_pixel};
  const bool is_checker = pattern.kind == PatternKind::checker;
  const Bands bands(frame.period, is_checker ? frame.period / 2 : width);
  switch (pattern.kind) {
    case PatternKind::none:
      return mask.fill(0);
    case PatternKind::checker:
      return frame.draw(mask, [&](Phase u, Phase v) {
        const float a = bands.at(u);
        const float b = bands.at(v);
        return a * b + (1 - a) * (1 - b);
      });
    case PatternKind::crosshatch:
      return frame.draw(mask, [&](Phase u, Phase v) { return std::max(bands.at(u), bands.at(v)); });
    case PatternKind::dots:
      return draw_dots(frame, width, mask);
    case PatternKind::hatch:
    case PatternKind::stripes:
      return frame.draw(mask, [&](Phase, Phase v) { return bands.at(v); });
  }
}

}  // namespace trapeze
