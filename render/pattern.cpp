#include "render/pattern.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trapeze {
namespace {

/// How much of the stretch of one pixel around `t` lies in bands of `width` that repeat after
/// `period`, one of them around 0. Taken across the bands, whatever their direction.
double band_coverage(double t, double period, double width) {
  if (width >= period) return 1;
  const double half = width / 2;
  const auto overlap = [half](double distance) {
    return std::max(0.0, std::min(distance + 0.5, half) - std::max(distance - 0.5, -half));
  };
  const double distance = std::abs(t - period * std::nearbyint(t / period));
  return std::min(1.0, overlap(distance) + overlap(period - distance));
}

/// Of dots on a square grid; u and v are coordinates along it. Dots smaller than a pixel are
/// paler instead.
double dot_coverage(double u, double v, double period, double width) {
  const double du = u - period * std::nearbyint(u / period);
  const double dv = v - period * std::nearbyint(v / period);
  const double radius = std::max(width / 2, 0.5);
  const double share = std::min(1.0, width * width);
  return share * std::clamp(radius + 0.5 - std::hypot(du, dv), 0.0, 1.0);
}

double checker_coverage(double u, double v, double period) {
  const double a = band_coverage(u, period, period / 2);
  const double b = band_coverage(v, period, period / 2);
  return a * b + (1 - a) * (1 - b);
}

/// `u` runs along the direction of the pattern, `v` across; all in pixels of the picture.
double coverage_at(PatternKind kind, double u, double v, double period, double width) {
  switch (kind) {
    case PatternKind::none:
      break;
    case PatternKind::checker:
      return checker_coverage(u, v, period);
    case PatternKind::crosshatch:
      return std::max(band_coverage(u, period, width), band_coverage(v, period, width));
    case PatternKind::dots:
      return dot_coverage(u, v, period, width);
    case PatternKind::hatch:
    case PatternKind::stripes:
      return band_coverage(v, period, width);
  }
  return 0;
}

}  // namespace

void draw_pattern(const Pattern& pattern, const View& view, int scale, Coverage& levels) {
  levels.resize(view.width, view.height);
  const double period = pattern.size * scale;
  const double width = pattern.width * scale;
  const double angle = pattern.angle * std::numbers::pi / 180;
  const double along_x = std::cos(angle);
  const double along_y = -std::sin(angle);  // rows run south
  const double west = static_cast<double>(view.origin_x - kGridMin) / view.cells_per_pixel;
  const double north = static_cast<double>(view.origin_y - kGridMin) / view.cells_per_pixel;
  for (int row = 0; row < view.height; ++row) {
    const double y = north + row + 0.5;
    std::uint8_t* out = levels.row_begin(row);
    for (int column = 0; column < view.width; ++column) {
      const double x = west + column + 0.5;
      const double u = x * along_x + y * along_y;
      const double v = y * along_x - x * along_y;
      const double coverage = coverage_at(pattern.kind, u, v, period, width);
      out[column] = static_cast<std::uint8_t>(coverage * 255 + 0.5);
    }
  }
}

}  // namespace trapeze
