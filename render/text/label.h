// A line of text on a plate of its own.
#pragma once

#include <string_view>

#include "render/text/fonts.h"

namespace trapeze {

/// Draws a line of text on a plate of white, to be read on any ground; `left` and `top` are those
/// of the plate. Nothing is drawn if the text has no width. `picture` is not indexed.
void draw_label(std::string_view line, int left, int top, const TextStyle& style,
                const Fonts& fonts, Picture& picture);

}  // namespace trapeze
