#include "render/text/bitmap_text.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace trapeze {
namespace {

constexpr int kTextHeight = kTextAscent + kTextDescent;
constexpr int kTextGap = 1;  // between letters

struct Glyph {
  std::uint8_t width;
  std::array<std::uint8_t, kTextHeight> rows;  // bits, the rightmost pixel lowest
};

constexpr char32_t kFirstGlyph = ' ';

// clang-format off
constexpr std::array<Glyph, 95> kGlyphs{{
    {3, {0, 0, 0, 0, 0, 0, 0, 0, 0}},  // space
    {1, {1, 1, 1, 1, 0, 0, 1, 0, 0}},  // !
    {3, {5, 5, 5, 0, 0, 0, 0, 0, 0}},  // "
    {5, {10, 10, 31, 10, 31, 10, 10, 0, 0}},  // #
    {5, {4, 15, 20, 14, 5, 30, 4, 0, 0}},  // $
    {5, {24, 25, 2, 4, 8, 19, 3, 0, 0}},  // %
    {5, {12, 18, 20, 8, 21, 18, 13, 0, 0}},  // &
    {1, {1, 1, 1, 0, 0, 0, 0, 0, 0}},  // '
    {3, {1, 2, 4, 4, 4, 2, 1, 0, 0}},  // (
    {3, {4, 2, 1, 1, 1, 2, 4, 0, 0}},  // )
    {5, {0, 4, 21, 14, 21, 4, 0, 0, 0}},  // *
    {5, {0, 4, 4, 31, 4, 4, 0, 0, 0}},  // +
    {2, {0, 0, 0, 0, 0, 3, 3, 2, 0}},  // ,
    {3, {0, 0, 0, 7, 0, 0, 0, 0, 0}},  // -
    {2, {0, 0, 0, 0, 0, 3, 3, 0, 0}},  // .
    {5, {1, 1, 2, 4, 8, 16, 16, 0, 0}},  // /
    {5, {14, 17, 19, 21, 25, 17, 14, 0, 0}},  // 0
    {3, {2, 6, 2, 2, 2, 2, 7, 0, 0}},  // 1
    {5, {14, 17, 1, 2, 4, 8, 31, 0, 0}},  // 2
    {5, {14, 17, 1, 6, 1, 17, 14, 0, 0}},  // 3
    {5, {2, 6, 10, 18, 31, 2, 2, 0, 0}},  // 4
    {5, {31, 16, 30, 1, 1, 17, 14, 0, 0}},  // 5
    {5, {6, 8, 16, 30, 17, 17, 14, 0, 0}},  // 6
    {5, {31, 1, 2, 4, 8, 8, 8, 0, 0}},  // 7
    {5, {14, 17, 17, 14, 17, 17, 14, 0, 0}},  // 8
    {5, {14, 17, 17, 15, 1, 2, 12, 0, 0}},  // 9
    {2, {0, 0, 3, 3, 0, 3, 3, 0, 0}},  // :
    {2, {0, 0, 3, 3, 0, 3, 3, 2, 0}},  // ;
    {4, {1, 2, 4, 8, 4, 2, 1, 0, 0}},  // <
    {5, {0, 0, 31, 0, 31, 0, 0, 0, 0}},  // =
    {4, {8, 4, 2, 1, 2, 4, 8, 0, 0}},  // >
    {5, {14, 17, 1, 2, 4, 0, 4, 0, 0}},  // ?
    {5, {14, 17, 23, 21, 23, 16, 14, 0, 0}},  // @
    {5, {14, 17, 17, 31, 17, 17, 17, 0, 0}},  // A
    {5, {30, 17, 17, 30, 17, 17, 30, 0, 0}},  // B
    {5, {14, 17, 16, 16, 16, 17, 14, 0, 0}},  // C
    {5, {30, 17, 17, 17, 17, 17, 30, 0, 0}},  // D
    {5, {31, 16, 16, 30, 16, 16, 31, 0, 0}},  // E
    {5, {31, 16, 16, 30, 16, 16, 16, 0, 0}},  // F
    {5, {14, 17, 16, 23, 17, 17, 15, 0, 0}},  // G
    {5, {17, 17, 17, 31, 17, 17, 17, 0, 0}},  // H
    {3, {7, 2, 2, 2, 2, 2, 7, 0, 0}},  // I
    {5, {7, 2, 2, 2, 2, 18, 12, 0, 0}},  // J
    {5, {17, 18, 20, 24, 20, 18, 17, 0, 0}},  // K
    {5, {16, 16, 16, 16, 16, 16, 31, 0, 0}},  // L
    {5, {17, 27, 21, 21, 17, 17, 17, 0, 0}},  // M
    {5, {17, 25, 25, 21, 19, 19, 17, 0, 0}},  // N
    {5, {14, 17, 17, 17, 17, 17, 14, 0, 0}},  // O
    {5, {30, 17, 17, 30, 16, 16, 16, 0, 0}},  // P
    {5, {14, 17, 17, 17, 21, 18, 13, 0, 0}},  // Q
    {5, {30, 17, 17, 30, 20, 18, 17, 0, 0}},  // R
    {5, {14, 17, 16, 14, 1, 17, 14, 0, 0}},  // S
    {5, {31, 4, 4, 4, 4, 4, 4, 0, 0}},  // T
    {5, {17, 17, 17, 17, 17, 17, 14, 0, 0}},  // U
    {5, {17, 17, 17, 17, 10, 10, 4, 0, 0}},  // V
    {5, {17, 17, 17, 21, 21, 21, 10, 0, 0}},  // W
    {5, {17, 17, 10, 4, 10, 17, 17, 0, 0}},  // X
    {5, {17, 17, 10, 4, 4, 4, 4, 0, 0}},  // Y
    {5, {31, 1, 2, 4, 8, 16, 31, 0, 0}},  // Z
    {3, {7, 4, 4, 4, 4, 4, 7, 0, 0}},  // [
    {5, {16, 16, 8, 4, 2, 1, 1, 0, 0}},  // backslash
    {3, {7, 1, 1, 1, 1, 1, 7, 0, 0}},  // ]
    {5, {4, 10, 17, 0, 0, 0, 0, 0, 0}},  // ^
    {5, {0, 0, 0, 0, 0, 0, 0, 31, 0}},  // _
    {2, {2, 1, 0, 0, 0, 0, 0, 0, 0}},  // `
    {5, {0, 0, 14, 1, 15, 17, 15, 0, 0}},  // a
    {5, {16, 16, 30, 17, 17, 17, 30, 0, 0}},  // b
    {5, {0, 0, 14, 17, 16, 17, 14, 0, 0}},  // c
    {5, {1, 1, 15, 17, 17, 17, 15, 0, 0}},  // d
    {5, {0, 0, 14, 17, 31, 16, 14, 0, 0}},  // e
    {4, {3, 4, 14, 4, 4, 4, 4, 0, 0}},  // f
    {5, {0, 0, 15, 17, 17, 17, 15, 1, 14}},  // g
    {5, {16, 16, 22, 25, 17, 17, 17, 0, 0}},  // h
    {3, {2, 0, 6, 2, 2, 2, 7, 0, 0}},  // i
    {4, {1, 0, 3, 1, 1, 1, 1, 9, 6}},  // j
    {4, {8, 8, 9, 10, 12, 10, 9, 0, 0}},  // k
    {3, {6, 2, 2, 2, 2, 2, 7, 0, 0}},  // l
    {5, {0, 0, 26, 21, 21, 21, 21, 0, 0}},  // m
    {5, {0, 0, 22, 25, 17, 17, 17, 0, 0}},  // n
    {5, {0, 0, 14, 17, 17, 17, 14, 0, 0}},  // o
    {5, {0, 0, 30, 17, 17, 17, 30, 16, 16}},  // p
    {5, {0, 0, 15, 17, 17, 17, 15, 1, 1}},  // q
    {5, {0, 0, 22, 25, 16, 16, 16, 0, 0}},  // r
    {5, {0, 0, 15, 16, 14, 1, 30, 0, 0}},  // s
    {4, {4, 4, 14, 4, 4, 4, 3, 0, 0}},  // t
    {5, {0, 0, 17, 17, 17, 19, 13, 0, 0}},  // u
    {5, {0, 0, 17, 17, 17, 10, 4, 0, 0}},  // v
    {5, {0, 0, 17, 21, 21, 21, 10, 0, 0}},  // w
    {5, {0, 0, 17, 10, 4, 10, 17, 0, 0}},  // x
    {5, {0, 0, 17, 17, 17, 17, 15, 1, 14}},  // y
    {5, {0, 0, 31, 2, 4, 8, 31, 0, 0}},  // z
    {3, {1, 2, 2, 4, 2, 2, 1, 0, 0}},  // {
    {1, {1, 1, 1, 1, 1, 1, 1, 0, 0}},  // |
    {3, {4, 2, 2, 1, 2, 2, 4, 0, 0}},  // }
    {5, {0, 0, 8, 21, 2, 0, 0, 0, 0}},  // ~
}};
// clang-format on

constexpr Glyph kUnknownGlyph{5, {31, 17, 17, 17, 17, 17, 31, 0, 0}};

constexpr char32_t kFirstAccented = 0xc0;
/// The letters below the accents of U+00C0 to U+017F.
constexpr std::string_view kBaseLetters =
    "AAAAAAACEEEEIIIIDNOOOOOxOUUUUYTsaaaaaaaceeeeiiiidnooooo/ouuuuyty"
    "AaAaAaCcCcCcCcDdDdEeEeEeEeEeGgGgGgGgHhHhIiIiIiIiIiIiJjKkkLlLlLlLlLlNnNnNnnNnOoOoOoOoRrRrRrSs"
    "SsSsSsTtTtTtUuUuUuUuUuUuWwYyYZzZzZzs";
static_assert(kBaseLetters.size() == 0x180 - kFirstAccented);

const Glyph& glyph_of(char32_t c) {
  if (c >= kFirstAccented && c < 0x180) {
    c = static_cast<unsigned char>(kBaseLetters[c - kFirstAccented]);
  }
  const bool is_known = c >= kFirstGlyph && c < kFirstGlyph + kGlyphs.size();
  return is_known ? kGlyphs[c - kFirstGlyph] : kUnknownGlyph;
}

/// Takes the first character off `text`, which is not empty; a byte that is no UTF-8 is a character
/// of its own.
char32_t take_character(std::string_view& text) {
  constexpr char32_t kNoCharacter = 0xfffd;
  const auto byte_at = [&text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte_at(0);
  std::size_t length = 1;
  if (first >= 0xc2) length = first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  char32_t character = first < 0x80 ? first : kNoCharacter;
  if (length > 1 && length <= text.size()) {
    character = first & (0x7fu >> length);
    for (std::size_t i = 1; i < length; ++i) {
      if ((byte_at(i) & 0xc0) != 0x80) {
        character = kNoCharacter;
        length = 1;
        break;
      }
      character = character << 6 | (byte_at(i) & 0x3fu);
    }
  } else {
    length = 1;
  }
  text.remove_prefix(length);
  return character;
}

/// Fills the part of a square that lies in the picture.
void fill_square(int left, int top, int side, Rgba colour, Picture& picture) {
  for (int y = std::max(top, 0); y < std::min(top + side, picture.height); ++y) {
    for (int x = std::max(left, 0); x < std::min(left + side, picture.width); ++x) {
      picture.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                     static_cast<std::size_t>(x)] = colour;
    }
  }
}

}  // namespace

int text_width(std::string_view text) {
  int width = 0;
  while (!text.empty()) width += glyph_of(take_character(text)).width + kTextGap;
  return std::max(0, width - kTextGap);
}

void draw_text(std::string_view text, int left, int top, int zoom, Rgba colour, Picture& picture) {
  while (!text.empty() && left < picture.width) {
    const Glyph& glyph = glyph_of(take_character(text));
    for (int y = 0; y < kTextHeight; ++y) {
      for (int x = 0; x < glyph.width; ++x) {
        const bool is_set =
            (glyph.rows[static_cast<std::size_t>(y)] >> (glyph.width - 1 - x) & 1) != 0;
        if (is_set) fill_square(left + x * zoom, top + y * zoom, zoom, colour, picture);
      }
    }
    left += (glyph.width + kTextGap) * zoom;
  }
}

}  // namespace trapeze
