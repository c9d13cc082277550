#include "render/text/label.h"

#include "render/picture/blend.h"

namespace trapeze {

void draw_label(std::string_view line, int left, int top, const TextStyle& style,
                const Fonts& fonts, Picture& picture) {
  constexpr Rgba kPlate{255, 255, 255, 255};
  constexpr int kMargin = 2;
  const int width = fonts.width_of(line, style.size);
  if (width == 0) return;
  const int ascent = style.size;
  const int descent = style.size / 4;
  for (int y = top; y < top + ascent + descent + kMargin; ++y) {
    for (int x = left; x < left + width + 2 * kMargin; ++x) blend(picture, x, y, kPlate, 1);
  }
  fonts.draw(line, left + kMargin, top + ascent, style, picture);
}

}  // namespace trapeze
