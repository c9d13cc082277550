#include "render/picture/paint.h"

#include <cstdint>

namespace trapeze {
namespace {

std::uint8_t to_byte(float share) {
  return static_cast<std::uint8_t>(to_byte_and_half(share));
}

}  // namespace

Paint over(const Paint& above, const Paint& below, const Meeting& meeting) {
  if (above.covered == 0 || below.covered == 0) return over(above, below);
  const auto [covered, common] = shares_of(below.covered, above.covered, meeting);
  const float opacity = above.a / above.covered;
  const float left = (1.0f - opacity * common / covered) * covered / below.covered;
  Paint sum = mixed(above, 1.0f, below, left);
  sum.covered = above.covered + covered - common;
  sum.beneath = below.beneath * left + (above.covered - common) * (1.0f - opacity);
  return sum;
}

Paint settled(const Paint& sum) {
  constexpr float kHalfValue = 0.501f / 255;  // including rounding errors of the sum
  const bool is_whole = sum.classes > 1 && sum.covered > 1 - kHalfValue * sum.classes;
  if (!is_whole && sum.covered <= 1) return sum;
  Paint paint = mixed(sum, 1 / sum.covered, {}, 0.0f);
  paint.covered = 1;
  return paint;
}

Rgba to_rgba(const Paint& paint) {
  const std::uint8_t a = to_byte(paint.a);
  if (a == 0) return kTransparent;
  const float scale = 1.0f / paint.a;
  return {to_byte(paint.r * scale), to_byte(paint.g * scale), to_byte(paint.b * scale), a};
}

}  // namespace trapeze
