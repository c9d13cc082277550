// Short lines of text in a picture, in letters drawn pixel by pixel: enough for legends, without a
// font that would have to be there.
#pragma once

#include <string_view>

#include "render/picture/compose.h"

namespace trapeze {

constexpr int kTextAscent = 7;   // pixels of a line above its base line, at zoom 1
constexpr int kTextDescent = 2;  // and below

/// How wide `text` is drawn, in pixels at zoom 1. `text` is UTF-8: ASCII and, without their
/// accents, the Latin letters up to U+017F are known; anything else is drawn as a small box.
int text_width(std::string_view text);

/// Draws a line of text whose letters are `zoom` times as large; `left` and `top` are those of its
/// first pixel. What lies outside of the picture is left out. `picture` is not indexed.
void draw_text(std::string_view text, int left, int top, int zoom, Rgba colour, Picture& picture);

}  // namespace trapeze
