#include "server/labels/broken_lines.h"

#include <algorithm>

#include "render/text/utf8.h"

namespace trapeze {
namespace {

/// A part of the text that is not broken, and whether a space precedes it.
struct Chunk {
  std::string_view text;
  bool follows_space = false;
  double width = 0;  // ems
};

std::size_t bytes_of_character(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xf0) return 4;
  if (first >= 0xe0) return 3;
  return first >= 0xc0 ? 2 : 1;
}

/// Ideographs, kana and Hangul syllables: lines may be broken between them.
bool is_ideograph(std::string_view character) {
  const std::u32string one = characters_of_line(character, 1);
  if (one.empty()) return false;
  const char32_t c = one.front();
  return (c >= 0x3040 && c < 0x3100) || (c >= 0x3400 && c < 0xa000) || (c >= 0xac00 && c < 0xd7a4);
}

/// Combining marks, as of decomposed kana, and variation selectors, as in the names of Japanese
/// places: they are part of the character before them.
bool is_mark(std::string_view character) {
  const std::u32string one = characters_of_line(character, 1);
  if (one.empty()) return false;
  const char32_t c = one.front();
  return (c >= 0x300 && c < 0x370) || (c >= 0x302a && c < 0x3030) || c == 0x3099 || c == 0x309a ||
         (c >= 0xfe00 && c < 0xfe10) || (c >= 0xe0100 && c < 0xe01f0);
}

std::vector<Chunk> chunks_of(std::string_view text) {
  std::vector<Chunk> chunks;
  bool may_join = false;
  bool after_space = false;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t bytes =
        std::min(bytes_of_character(static_cast<unsigned char>(text[i])), text.size() - i);
    const std::string_view character = text.substr(i, bytes);
    i += bytes;
    if (character == " ") {
      may_join = false;
      after_space = true;
      continue;
    }
    const bool is_continued = !chunks.empty() && !after_space && is_mark(character);
    const bool stands_alone = is_ideograph(character);
    if (is_continued || (may_join && !stands_alone)) {
      Chunk& last = chunks.back();
      last.text = text.substr(static_cast<std::size_t>(last.text.data() - text.data()),
                              last.text.size() + bytes);
    } else {
      chunks.push_back({character, after_space});
    }
    if (is_continued) continue;
    after_space = false;
    may_join = !(character == "-" || character == "/" || character == "," || stands_alone);
  }
  return chunks;
}

/// The indexes of the chunks after which lines end, with no line wider than `most`.
std::vector<std::size_t> ends_of_lines(const std::vector<Chunk>& chunks, double most,
                                       double space) {
  std::vector<std::size_t> ends;
  double width = 0;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const double more = chunks[i].width + (chunks[i].follows_space ? space : 0);
    if (i > 0 && width + more > most) {
      ends.push_back(i);
      width = chunks[i].width;
    } else {
      width += i == 0 ? chunks[i].width : more;
    }
  }
  ends.push_back(chunks.size());
  return ends;
}

}  // namespace

BrokenLines broken_lines(std::string_view text, double most, const Fonts& fonts) {
  const Fonts::Extent whole = fonts.extent_of(text);
  if (whole.width <= most) return {{std::string(text)}, whole.width, whole.height};
  std::vector<Chunk> chunks = chunks_of(text);
  double widest = 0;
  for (Chunk& chunk : chunks) {
    chunk.width = fonts.extent_of(chunk.text).width;
    widest = std::max(widest, chunk.width);
  }
  const double space = fonts.extent_of(" ").width;
  std::vector<std::size_t> ends = ends_of_lines(chunks, most, space);
  // The smallest width that gives the same number of lines.
  double narrow = std::max(widest, whole.width / static_cast<double>(ends.size()));
  double wide = std::max(most, widest);
  for (int i = 0; i < 8; ++i) {
    const double middle = (narrow + wide) / 2;
    (ends_of_lines(chunks, middle, space).size() > ends.size() ? narrow : wide) = middle;
  }
  ends = ends_of_lines(chunks, wide, space);
  BrokenLines broken{{}, 0, whole.height};
  std::size_t first = 0;
  for (const std::size_t end : ends) {
    std::string& line = broken.lines.emplace_back();
    for (std::size_t i = first; i < end; ++i) {
      if (i > first && chunks[i].follows_space) line += ' ';
      line += chunks[i].text;
    }
    broken.width = std::max(broken.width, fonts.extent_of(line).width);
    first = end;
  }
  return broken;
}

}  // namespace trapeze
