// Draws lines of text, in any script: reordered by FriBidi, shaped by HarfBuzz (both through Raqm)
// and rasterized by FreeType.
//
// Fonts are named by their files, in order of fallback, so that what is drawn depends on these
// files only. For a family name, fontconfig would return some font even if the name is wrong, by
// rules and caches that differ from machine to machine and that a container may lack.
//
// A character is drawn in the first font that has it together with the marks that follow it. A
// character that no font has is drawn as the first font's missing glyph, usually a box.
//
// Thread-safety: const methods may be called from any thread. A FreeType face may be used by one
// thread at a time, so calls are serialized by a mutex, which is held for at most kMostCharacters
// at a time. Fonts must be added before other threads use the object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/picture/picture.h"

namespace trapeze {

struct TextStyle {
  int size = 12;  // side of the em square in pixels, 1 to kMostTextSize
  Rgba colour;
};

constexpr int kMostTextSize = 256;

/// How much of each pixel is covered by the letters of a text, and by the letters together with the
/// halo around them: 0 to 255. Column 0 of row 0 is the north-west pixel.
struct TextMask {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> letters;  // row by row
  std::vector<std::uint8_t> halo;     // row by row; never less than letters
};

class Fonts {
 public:
  /// Longer lines are truncated, so that the work is bounded for any text.
  static constexpr std::size_t kMostCharacters = 512;

  /// Without fonts, every text has zero width.
  Fonts();
  ~Fonts();
  Fonts(const Fonts&) = delete;
  Fonts& operator=(const Fonts&) = delete;

  /// Adds a font of the lowest priority so far: the name of a file of outlines (TrueType, OpenType,
  /// Type 1 ...), or "FILE#N" for font N, from 0, of a collection. Throws std::runtime_error, which
  /// names the file, if there is no such file or its font cannot be used.
  void add(const std::string& file);
  bool is_empty() const;

  /// Equal for fonts and libraries that draw all text in the same way.
  std::string identity() const;

  /// The width of a line in pixels, rounded up. `line` is UTF-8, read as characters_of_line() does.
  int width_of(std::string_view line, int size) const;

  /// The line if it is at most `width` pixels wide; otherwise its longest prefix that is with an
  /// ellipsis appended; an ellipsis alone if none is.
  std::string fitted(std::string_view line, int size, int width) const;

  /// Draws a line of text that begins at column `left`, its baseline being the upper side of row
  /// `base`. It is clipped to the picture. `picture` is not indexed.
  void draw(std::string_view line, int left, int base, const TextStyle& style,
            Picture& picture) const;

  struct Extent {
    double width = 0;   // in ems; a drawn line is at most that wide, within a pixel
    double height = 0;  // in ems: the line spacing at which letters do not touch
  };
  /// The extent of a line at any size. Fast for scripts whose letters are independent: their widths
  /// are added up.
  Extent extent_of(std::string_view line) const;

  /// Whether the fonts have all characters of the line; otherwise some are drawn as boxes.
  bool can_write(std::string_view line) const;

  /// Draws the lines below each other, each centred horizontally. The text, with a height of
  /// `line_height` per line, is centred vertically, on the middle of the mask, where the corners of
  /// four pixels meet. Anything outside the mask is cut off. `size`, 1 to kMostTextSize, and
  /// `halo`, its width, 0 or more, are in pixels.
  TextMask mask_of(std::span<const std::string> lines, double size, double line_height, double halo,
                   int width, int height) const;

 private:
  class Faces;
  std::unique_ptr<Faces> faces_;
};

}  // namespace trapeze
