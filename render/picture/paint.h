// Colours that cover a part of a pixel, and how they lie over and beside each other.
#pragma once

#include "render/picture/colour.h"
#include "render/picture/meeting.h"

namespace trapeze {

/// What one or several layers show of a pixel. Colours are premultiplied; all from 0 to 1.
struct Paint {
  float r = 0;
  float g = 0;
  float b = 0;
  float a = 0;
  float covered = 0;  // how much of the pixel they cover, however transparent they are
  float beneath = 0;  // how much of it shows what lies beneath them through what they cover
  float classes = 0;  // within a layer only: how many there are
};

/// Of something that covers that share of the pixel.
inline Paint to_paint(Rgba colour, float share, float opacity = 1) {
  const float a = static_cast<float>(colour.a) / 255.0f * share * opacity;
  const float scale = a / 255.0f;
  return {static_cast<float>(colour.r) * scale, static_cast<float>(colour.g) * scale,
          static_cast<float>(colour.b) * scale, a, share};
}

/// The colours of one times a factor, and those of the other times a factor; the rest is that of
/// the other.
inline Paint mixed(const Paint& one, float of_one, const Paint& other, float of_other) {
  Paint sum = other;
  sum.r = one.r * of_one + other.r * of_other;
  sum.g = one.g * of_one + other.g * of_other;
  sum.b = one.b * of_one + other.b * of_other;
  sum.a = one.a * of_one + other.a * of_other;
  return sum;
}

inline Paint faded(const Paint& paint, float opacity) {
  Paint fainter = mixed(paint, opacity, {}, 0);
  fainter.covered = paint.covered;
  return fainter;
}

/// Lays a paint over another one that covers the same places as often as chance has it.
Paint over(const Paint& above, const Paint& below);

/// Lays a paint over another one, of which it is known how they lie in the pixel.
Paint over(const Paint& above, const Paint& below, const Meeting& meeting);

/// Adds what shines of a class through others.
inline Paint added(const Paint& one, const Paint& other) {
  return mixed(one, 1, other, 1);
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

Rgba to_rgba(const Paint& paint);

}  // namespace trapeze
