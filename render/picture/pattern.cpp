#include "render/picture/pattern.h"

#include <algorithm>
#include <cmath>
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

/// The same for all places of a period, looked up.
class Bands {
 public:
  Bands(double period, double width) {
    const int count = std::max(1, static_cast<int>(std::ceil(period * kStepsPerPixel)));
    per_pixel_ = count / period;
    for (int i = 0; i < count; ++i) {
      values_.push_back(static_cast<float>(band_value((i + 0.5) / per_pixel_, period, width)));
    }
  }

  /// 0 <= place < period.
  float at(double place) const {
    return values_[std::min(static_cast<std::size_t>(place * per_pixel_), values_.size() - 1)];
  }

 private:
  static constexpr double kStepsPerPixel = 64;

  double per_pixel_ = 1;
  std::vector<float> values_;
};

/// A coordinate that grows from pixel to pixel by less than the period, within 0 and the period.
class Cycle {
 public:
  Cycle(double start, double step, double period)
      : place_(start - period * std::floor(start / period)), step_(step), period_(period) {
    wrap();
  }

  double place() const { return place_; }
  void advance() {
    place_ += step_;
    wrap();
  }

 private:
  void wrap() {
    if (place_ >= period_) place_ -= period_;
    if (place_ < 0) place_ += period_;
  }

  double place_;
  double step_;
  double period_;
};

/// Where a pattern lies in one picture: u runs along its direction, v across, in pixels.
struct Frame {
  const View& view;
  double period;
  double along_x;
  double along_y;
  double west;  // of the picture, from the corner of the world
  double north;

  /// Calls value_at(u, v), both within the period, for every pixel.
  template <typename ValueAt>
  void draw(Mask& mask, const ValueAt& value_at) const {
    const double x = west + 0.5;
    for (int row = 0; row < view.height; ++row) {
      const double y = north + row + 0.5;
      Cycle u(x * along_x + y * along_y, along_x, period);
      Cycle v(y * along_x - x * along_y, -along_y, period);
      std::uint8_t* out = mask.row_begin(row);
      for (int column = 0; column < view.width; ++column) {
        out[column] = static_cast<std::uint8_t>(value_at(u.place(), v.place()) * 255 + 0.5f);
        u.advance();
        v.advance();
      }
    }
  }
};

void draw_dots(const Frame& frame, double width, Mask& mask) {
  // Dots smaller than a pixel are paler instead.
  const double radius = std::max(width / 2, 0.5);
  const auto share = static_cast<float>(std::min(1.0, width * width));
  const double reach = radius + 0.5;
  frame.draw(mask, [&](double u, double v) {
    const double du = std::min(u, frame.period - u);
    const double dv = std::min(v, frame.period - v);
    if (du >= reach || dv >= reach) return 0.0f;
    const double off = reach - std::sqrt(du * du + dv * dv);
    return share * static_cast<float>(std::clamp(off, 0.0, 1.0));
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
      return frame.draw(mask, [&](double u, double v) {
        const float a = bands.at(u);
        const float b = bands.at(v);
        return a * b + (1 - a) * (1 - b);
      });
    case PatternKind::crosshatch:
      return frame.draw(mask,
                        [&](double u, double v) { return std::max(bands.at(u), bands.at(v)); });
    case PatternKind::dots:
      return draw_dots(frame, width, mask);
    case PatternKind::hatch:
    case PatternKind::stripes:
      return frame.draw(mask, [&](double, double v) { return bands.at(v); });
  }
}

}  // namespace trapeze
