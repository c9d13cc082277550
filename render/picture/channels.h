// Colours as comparable numbers: channels premultiplied by the opacity, 0 to 255.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

#include "render/picture/colour.h"

namespace trapeze {

/// Divides and rounds to the nearest integer. Precondition: value >= 0, divisor > 0.
constexpr int divided(int value, int divisor) {
  return (2 * value + divisor) / (2 * divisor);
}

/// Each from 0 to 255; no colour channel is greater than the opacity.
struct Channels {
  int r = 0;
  int g = 0;
  int b = 0;
  int a = 0;
};

inline Channels channels_of(Rgba colour) {
  const auto scaled = [a = colour.a](std::uint8_t channel) { return divided(channel * a, 255); };
  return {scaled(colour.r), scaled(colour.g), scaled(colour.b), colour.a};
}

/// The colour that channels_of() converts to these channels.
inline Rgba straight(const Channels& channels) {
  const int a = channels.a;
  if (a == 0) return kTransparent;
  const auto scaled = [a](int channel) {
    return static_cast<std::uint8_t>(std::min(255, divided(channel * 255, a)));
  };
  return {scaled(channels.r), scaled(channels.g), scaled(channels.b), static_cast<std::uint8_t>(a)};
}

/// The difference of two colours.
struct Difference {
  int most = 0;  // of one channel
  int sum = 0;   // of all channels
};

inline Difference difference(const Channels& one, const Channels& other) {
  const std::array apart{std::abs(one.r - other.r), std::abs(one.g - other.g),
                         std::abs(one.b - other.b), std::abs(one.a - other.a)};
  return {std::max({apart[0], apart[1], apart[2], apart[3]}),
          apart[0] + apart[1] + apart[2] + apart[3]};
}

}  // namespace trapeze
