#include "render/text/fonts.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H
#include <hb.h>
#include <raqm.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <mutex>
#include <new>
#include <stdexcept>
#include <vector>

#include "render/picture/blend.h"
#include "render/text/utf8.h"

namespace trapeze {
namespace {

// Hinted in height only: sharp rows, and widths that grow in proportion to the size.
constexpr FT_Int32 kLoadFlags = FT_LOAD_TARGET_LIGHT | FT_LOAD_NO_BITMAP;
constexpr std::string_view kEllipsis = "\u2026";

struct CloseLibrary {
  void operator()(FT_Library library) const { FT_Done_FreeType(library); }
};
struct CloseFace {
  void operator()(FT_Face face) const { FT_Done_Face(face); }
};
struct DestroyLayout {
  void operator()(raqm_t* layout) const { raqm_destroy(layout); }
};
using Library = std::unique_ptr<FT_LibraryRec_, CloseLibrary>;
using Face = std::unique_ptr<FT_FaceRec_, CloseFace>;
using Layout = std::unique_ptr<raqm_t, DestroyLayout>;

Library open_library() {
  FT_Library library = nullptr;
  if (FT_Init_FreeType(&library) != 0) throw std::runtime_error("FreeType cannot be initialized");
  return Library(library);
}

/// A font of a file that may be a collection.
struct FontName {
  std::string file;
  FT_Long number = 0;
};

FontName parse_font_name(const std::string& name) {
  const std::size_t sign = name.rfind('#');
  if (sign == std::string::npos) return {name};
  FT_Long number = 0;
  const char* end = name.data() + name.size();
  const auto [rest, error] = std::from_chars(name.data() + sign + 1, end, number);
  const bool is_number = error == std::errc() && rest == end && number >= 0 && number < 0x10000;
  return is_number ? FontName{name.substr(0, sign), number} : FontName{name};
}

/// The reason why a font cannot be used; null if it can.
const char* find_fault(FT_Face face) {
  if (FT_IS_SCALABLE(face) == 0) return "has no outlines, only pictures of fixed sizes";
  if (FT_Select_Charmap(face, FT_ENCODING_UNICODE) != 0) return "does not tell its characters";
  const bool is_drawn =
      FT_Set_Pixel_Sizes(face, 0, 16) == 0 && FT_Load_Glyph(face, 0, kLoadFlags) == 0;
  return is_drawn ? nullptr : "is broken: its letters cannot be read";
}

Face open_face(FT_Library library, const std::string& name) {
  const auto fail = [&name](const char* what) {
    throw std::runtime_error("the font " + name + " " + what);
  };
  const FontName font = parse_font_name(name);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(font.file, ignored)) fail("is not there");
  FT_Face opened = nullptr;
  const FT_Error error = FT_New_Face(library, font.file.c_str(), font.number, &opened);
  Face face(error == 0 ? opened : nullptr);
  if (error == FT_Err_Cannot_Open_Resource) fail("cannot be opened");
  if (error == FT_Err_Unknown_File_Format) fail("is in no format of fonts that is known");
  if (error != 0) fail("is broken, or its file has no font of that number");
  if (const char* fault = find_fault(face.get())) fail(fault);
  return face;
}

bool has(FT_Face face, char32_t character) {
  return FT_Get_Char_Index(face, character) != 0;
}

/// What belongs to the character before it.
enum class Following { none, mark, joiner };

Following following_of(char32_t character) {
  switch (hb_unicode_general_category(hb_unicode_funcs_get_default(), character)) {
    case HB_UNICODE_GENERAL_CATEGORY_SPACING_MARK:
    case HB_UNICODE_GENERAL_CATEGORY_ENCLOSING_MARK:
    case HB_UNICODE_GENERAL_CATEGORY_NON_SPACING_MARK:
      return Following::mark;
    case HB_UNICODE_GENERAL_CATEGORY_FORMAT:
      return Following::joiner;
    default:
      return Following::none;
  }
}

/// A glyph in its place on the line; lengths are in 64ths of a pixel, y upwards.
struct PlacedGlyph {
  FT_Face face;
  FT_UInt index;
  FT_Pos x;
  FT_Pos y;
};

struct ShapedLine {
  std::vector<PlacedGlyph> glyphs;
  FT_Pos width = 0;
};

void draw_glyph(const PlacedGlyph& glyph, int base, Rgba colour, Picture& picture) {
  FT_GlyphSlot slot = glyph.face->glyph;
  if (FT_Load_Glyph(glyph.face, glyph.index, kLoadFlags) != 0) return;
  if (slot->format != FT_GLYPH_FORMAT_OUTLINE) return;
  FT_Outline_Translate(&slot->outline, glyph.x & 63, glyph.y & 63);
  if (FT_Render_Glyph(slot, FT_RENDER_MODE_NORMAL) != 0) return;
  const FT_Bitmap& bitmap = slot->bitmap;
  const int left = static_cast<int>(glyph.x >> 6) + slot->bitmap_left;
  const int top = base - static_cast<int>(glyph.y >> 6) - slot->bitmap_top;
  for (int y = 0; y < static_cast<int>(bitmap.rows); ++y) {
    const unsigned char* row = bitmap.buffer + std::ptrdiff_t{y} * bitmap.pitch;
    for (int x = 0; x < static_cast<int>(bitmap.width); ++x) {
      if (row[x] > 0) blend(picture, left + x, top + y, colour, row[x] / 255.0);
    }
  }
}

/// The longest beginning of at most so many bytes that does not end within a character.
std::string_view beginning_of(std::string_view text, std::size_t bytes) {
  if (bytes >= text.size()) return text;
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xc0) == 0x80) --bytes;
  return text.substr(0, bytes);
}

}  // namespace

class Fonts::Faces {
 public:
  void add(const std::string& file) {
    faces_.push_back(open_face(library_.get(), file));
    size_ = 0;
  }
  bool is_empty() const { return faces_.empty(); }

  /// To be locked as long as faces are used.
  std::unique_lock<std::mutex> lock() { return std::unique_lock(mutex_); }

  ShapedLine shape(std::string_view line, int size) {
    const std::u32string text = characters_of_line(line, kMostCharacters);
    if (text.empty() || is_empty()) return {};
    set_size(std::clamp(size, 1, kMostTextSize));
    const Layout layout = lay_out(text);
    std::size_t count = 0;
    const raqm_glyph_t* glyphs = raqm_get_glyphs(layout.get(), &count);
    ShapedLine shaped;
    for (std::size_t i = 0; i < count; ++i) {
      const raqm_glyph_t& glyph = glyphs[i];
      shaped.glyphs.push_back(
          {glyph.ftface, glyph.index, shaped.width + glyph.x_offset, glyph.y_offset});
      shaped.width += glyph.x_advance;
    }
    return shaped;
  }

 private:
  void set_size(int size) {
    if (size == size_) return;
    for (const Face& face : faces_) FT_Set_Pixel_Sizes(face.get(), 0, static_cast<FT_UInt>(size));
    size_ = size;
  }

  Layout lay_out(const std::u32string& text) const {
    const std::vector<std::uint32_t> characters(text.begin(), text.end());
    Layout layout(raqm_create());
    const bool is_begun = layout != nullptr &&
                          raqm_set_text(layout.get(), characters.data(), characters.size()) &&
                          raqm_set_par_direction(layout.get(), RAQM_DIRECTION_DEFAULT) &&
                          raqm_set_freetype_load_flags(layout.get(), kLoadFlags);
    if (!is_begun) throw std::bad_alloc();
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = end_of_cluster(text, begin);
      if (!raqm_set_freetype_face_range(layout.get(), face_for(text, begin, end), begin,
                                        end - begin)) {
        throw std::bad_alloc();
      }
      begin = end;
    }
    if (!raqm_layout(layout.get())) throw std::bad_alloc();
    return layout;
  }

  /// Of a character with its marks.
  static std::size_t end_of_cluster(const std::u32string& text, std::size_t begin) {
    std::size_t end = begin + 1;
    while (end < text.size() && following_of(text[end]) != Following::none) ++end;
    return end;
  }

  /// The first face that has the whole cluster, or else its first character, or else the first.
  FT_Face face_for(const std::u32string& text, std::size_t begin, std::size_t end) const {
    const auto has_all = [&](const Face& face) {
      const auto is_there = [&](char32_t c) {
        return following_of(c) == Following::joiner || has(face.get(), c);
      };
      return std::all_of(text.begin() + static_cast<std::ptrdiff_t>(begin),
                         text.begin() + static_cast<std::ptrdiff_t>(end), is_there);
    };
    const auto has_first = [&](const Face& face) { return has(face.get(), text[begin]); };
    auto found = std::ranges::find_if(faces_, has_all);
    if (found == faces_.end()) found = std::ranges::find_if(faces_, has_first);
    return (found == faces_.end() ? faces_.front() : *found).get();
  }

  std::mutex mutex_;
  Library library_ = open_library();  // outlives the faces
  std::vector<Face> faces_;
  int size_ = 0;  // of all faces; 0: not yet set
};

Fonts::Fonts() : faces_(std::make_unique<Faces>()) {}
Fonts::~Fonts() = default;

void Fonts::add(const std::string& file) {
  faces_->add(file);
}

bool Fonts::is_empty() const {
  return faces_->is_empty();
}

int Fonts::width_of(std::string_view line, int size) const {
  const auto lock = faces_->lock();
  return static_cast<int>((faces_->shape(line, size).width + 63) >> 6);
}

std::string Fonts::fitted(std::string_view line, int size, int width) const {
  line = beginning_of(line, 4 * kMostCharacters);
  if (width_of(line, size) <= width) return std::string(line);
  const auto shortened = [line](std::size_t bytes) {
    return std::string(beginning_of(line, bytes)).append(kEllipsis);
  };
  std::size_t fits = 0;
  std::size_t exceeds = line.size();
  while (exceeds - fits > 1) {
    const std::size_t middle = fits + (exceeds - fits) / 2;
    (width_of(shortened(middle), size) <= width ? fits : exceeds) = middle;
  }
  return shortened(fits);
}

void Fonts::draw(std::string_view line, int left, int base, const TextStyle& style,
                 Picture& picture) const {
  const auto lock = faces_->lock();
  for (PlacedGlyph glyph : faces_->shape(line, style.size).glyphs) {
    glyph.x += FT_Pos{left} * 64;
    draw_glyph(glyph, base, style.colour, picture);
  }
}

}  // namespace trapeze
