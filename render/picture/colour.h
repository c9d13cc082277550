// Colours as written in URLs, styles and configuration files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace trapeze {

/// Red, green, blue and opacity in sRGB, not premultiplied.
struct Rgba {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  std::uint8_t a = 0;  // 0 transparent, 255 opaque

  friend constexpr bool operator==(Rgba, Rgba) = default;
};

constexpr Rgba kTransparent{0, 0, 0, 0};

/// Parses a colour; nothing if the text is not one. Ignores case. Accepts
///   rgb, rgba, rrggbb, rrggbbaa   hexadecimal, with or without # in front;
///   the 148 names of CSS, and transparent, or none;
///   rgb(...) and rgba(...) of CSS: three numbers (0..255) or three percentages, optionally an
///   opacity (0..1 or percent), separated by commas, or by spaces with a slash before the opacity.
/// As in CSS, numbers may have fractions, and numbers out of range are clamped.
std::optional<Rgba> parse_colour(std::string_view text);

/// rrggbbaa, lower case: equal colours have equal text, and parse_colour() parses it.
std::string to_hex(Rgba colour);

/// The colour with its opacity multiplied by `opacity`, 0..1, and rounded.
Rgba with_opacity(Rgba colour, double opacity);

}  // namespace trapeze
