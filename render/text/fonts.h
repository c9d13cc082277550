// Lines of text in a picture, in whatever script: brought in order by FriBidi, shaped by HarfBuzz
// (both through Raqm) and drawn by FreeType.
//
// Fonts are files, in the order in which they are asked: what is drawn then depends on nothing but
// these files. By family names, fontconfig would answer with some font even to a name that is
// wrong, by rules and caches that differ from machine to machine, which a container may not have.
//
// A character is drawn in the first font that has it together with the marks that follow it. One
// that no font has is the first font's sign for that, mostly a box.
//
// Thread-safety: const methods may be called from any thread. Faces of FreeType are for one thread
// at a time, so callers take turns at a mutex, with kMostCharacters at most a turn. Fonts are added
// before others use them.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "render/picture/compose.h"

namespace trapeze {

struct TextStyle {
  int size = 12;  // pixels of the em square, 1 to kMostTextSize; twice as many, twice as wide
  Rgba colour;
};

constexpr int kMostTextSize = 256;

class Fonts {
 public:
  /// What is longer is cut off there: work is bounded, whatever the text.
  static constexpr std::size_t kMostCharacters = 512;

  /// There are none: every text is empty.
  Fonts();
  ~Fonts();
  Fonts(const Fonts&) = delete;
  Fonts& operator=(const Fonts&) = delete;

  /// Adds a font behind the others: a file of outlines (TrueType, OpenType, Type 1 ...), and of
  /// a collection "FILE#N", its font number N from 0. Throws std::runtime_error, which names
  /// the file, if there is no such file or its font cannot be used.
  void add(const std::string& file);
  bool is_empty() const;

  /// How wide a line is, in pixels, rounded up. `line` is UTF-8, read as characters_of_line() does.
  int width_of(std::string_view line, int size) const;

  /// The line, or so much of its beginning as with an ellipsis is no wider than `width` pixels; the
  /// ellipsis alone may be wider.
  std::string fitted(std::string_view line, int size, int width) const;

  /// Draws a line from the column `left` on, its base line being the upper side of row `base`.
  /// What lies outside of the picture is left out. `picture` is not indexed.
  void draw(std::string_view line, int left, int base, const TextStyle& style,
            Picture& picture) const;

 private:
  class Faces;
  std::unique_ptr<Faces> faces_;
};

}  // namespace trapeze
