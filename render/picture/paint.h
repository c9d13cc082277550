// Colours that cover a part of a pixel, and how they lie over and beside each other.
#pragma once

#include "render/picture/colour.h"
#include "render/picture/meeting.h"

namespace trapeze {

/// What one or several layers show of a pixel. Colours are premultiplied; all from 0 to 1. Numbers
/// are floats, or vectors of them for as many pixels, which come out the same to the last bit.
template <typename Number>
struct PaintOf {
  Number r{};
  Number g{};
  Number b{};
  Number a{};
  Number covered{};  // how much of the pixel they cover, however transparent they are
  Number beneath{};  // how much of it shows what lies beneath them through what they cover
  Number classes{};  // within a layer only: how many there are
};

using Paint = PaintOf<float>;

/// Of something that covers that share of the pixel.
template <typename Number>
PaintOf<Number> to_paint(Rgba colour, Number share, float opacity = 1) {
  const Number a = static_cast<float>(colour.a) / 255.0f * share * opacity;
  const Number scale = a / 255.0f;
  return {static_cast<float>(colour.r) * scale, static_cast<float>(colour.g) * scale,
          static_cast<float>(colour.b) * scale, a, share};
}

/// The colours of one times a factor, and those of the other times a factor; the rest is that of
/// the other.
template <typename Number>
PaintOf<Number> mixed(const PaintOf<Number>& one, float of_one, const PaintOf<Number>& other,
                      Number of_other) {
  PaintOf<Number> sum = other;
  sum.r = one.r * of_one + other.r * of_other;
  sum.g = one.g * of_one + other.g * of_other;
  sum.b = one.b * of_one + other.b * of_other;
  sum.a = one.a * of_one + other.a * of_other;
  return sum;
}

inline Paint faded(const Paint& paint, float opacity) {
  Paint fainter = mixed(paint, opacity, {}, 0.0f);
  fainter.covered = paint.covered;
  return fainter;
}

/// Lays a paint over another one that covers the same places as often as chance has it. One that
/// covers nothing changes nothing.
template <typename Number>
PaintOf<Number> over(const PaintOf<Number>& above, const PaintOf<Number>& below) {
  PaintOf<Number> sum = mixed(above, 1.0f, below, 1.0f - above.a);
  sum.covered = above.covered + below.covered * (1.0f - above.covered);
  sum.beneath =
      below.beneath * (1.0f - above.a) + (1.0f - below.covered) * (above.covered - above.a);
  return sum;
}

/// Lays a paint over another one, of which it is known how they lie in the pixel.
Paint over(const Paint& above, const Paint& below, const Meeting& meeting);

/// Adds what shines of a class through others.
inline Paint added(const Paint& one, const Paint& other) {
  return mixed(one, 1.0f, other, 1.0f);
}

/// Adds a class that lies beside others.
inline Paint beside(const Paint& one, const Paint& other) {
  Paint sum = added(one, other);
  sum.covered += one.covered;
  sum.classes += 1;
  return sum;
}

/// A pattern's paint, wherever the classes below it are.
inline Paint within(const Paint& above, const Paint& below) {
  return mixed(above, below.covered, below, 1.0f - above.a);
}

/// The sum of classes. Where they overlap, each has its share. And where they join, each value was
/// rounded; the pixel is wholly covered all the same.
Paint settled(const Paint& sum);

/// From 0.5 to 255.5: what is left of it without fractions is the value of a byte.
template <typename Number>
Number to_byte_and_half(Number share) {
  const Number none{};
  const Number all = none + 1.0f;
  const Number at_least_none = share < none ? none : share;
  return (all < at_least_none ? all : at_least_none) * 255.0f + 0.5f;
}

Rgba to_rgba(const Paint& paint);

}  // namespace trapeze
