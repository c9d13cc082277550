// Colours that cover a part of a pixel, and how they are combined.
#pragma once

#include "render/picture/colour.h"
#include "render/picture/meeting.h"

namespace trapeze {

/// The contribution of one or more layers to a pixel. Colours are premultiplied; all values are
/// from 0 to 1. Numbers are floats, or vectors of floats for several pixels; both give
/// bit-identical results.
template <typename Number>
struct PaintOf {
  Number r{};
  Number g{};
  Number b{};
  Number a{};
  Number covered{};  // covered share of the pixel, regardless of opacity
  Number beneath{};  // share of the pixel in which the area beneath shows through
  Number classes{};  // only within a layer: the number of classes
};

using Paint = PaintOf<float>;

/// The paint of a colour that covers that share of the pixel.
template <typename Number>
PaintOf<Number> to_paint(Rgba colour, Number share, float opacity = 1) {
  const Number a = static_cast<float>(colour.a) / 255.0f * share * opacity;
  const Number scale = a / 255.0f;
  return {static_cast<float>(colour.r) * scale, static_cast<float>(colour.g) * scale,
          static_cast<float>(colour.b) * scale, a, share};
}

/// The weighted sum of the colours of both; all other values are those of `other`.
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

/// Draws a paint over another one, if the areas they cover are independent, as by chance. A paint
/// that covers nothing changes nothing.
template <typename Number>
PaintOf<Number> over(const PaintOf<Number>& above, const PaintOf<Number>& below) {
  PaintOf<Number> sum = mixed(above, 1.0f, below, 1.0f - above.a);
  sum.covered = above.covered + below.covered * (1.0f - above.covered);
  sum.beneath =
      below.beneath * (1.0f - above.a) + (1.0f - below.covered) * (above.covered - above.a);
  return sum;
}

/// Draws a paint over another one whose relation in the pixel is known.
Paint over(const Paint& above, const Paint& below, const Meeting& meeting);

/// Adds the part of a class that shows through others.
inline Paint added(const Paint& one, const Paint& other) {
  return mixed(one, 1.0f, other, 1.0f);
}

/// Adds a class that is beside others.
inline Paint beside(const Paint& one, const Paint& other) {
  Paint sum = added(one, other);
  sum.covered += one.covered;
  sum.classes += 1;
  return sum;
}

/// Draws the paint of a pattern over the area of the classes below it.
inline Paint within(const Paint& above, const Paint& below) {
  return mixed(above, below.covered, below, 1.0f - above.a);
}

/// The final sum of classes. If they overlap, each has its share. If they fill the pixel together,
/// it is fully covered despite the rounding of each value.
Paint settled(const Paint& sum);

/// From 0.5 to 255.5: truncated, it is the value of a byte.
template <typename Number>
Number to_byte_and_half(Number share) {
  const Number none{};
  const Number all = none + 1.0f;
  const Number at_least_none = share < none ? none : share;
  return (all < at_least_none ? all : at_least_none) * 255.0f + 0.5f;
}

Rgba to_rgba(const Paint& paint);

}  // namespace trapeze
