// A line of text on a white background.
#pragma once

#include <string_view>

#include "render/text/fonts.h"

namespace trapeze {

/// Draws a line of text on a white rectangle, so that it is legible on any picture. `left` and
/// `top` are the column and the row of the rectangle's north-west pixel. Nothing is drawn if the
/// text has no width.
void draw_label(std::string_view line, int left, int top, const TextStyle& style,
                const Fonts& fonts, Picture& picture);

}  // namespace trapeze
