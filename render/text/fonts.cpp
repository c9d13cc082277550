#include "render/text/fonts.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_GLYPH_H
#include FT_OUTLINE_H
#include FT_STROKER_H
#include FT_TRUETYPE_TABLES_H
#include <hb.h>
#include <raqm.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <new>
#include <stdexcept>
#include <unordered_map>
#include <vector>

#include "render/picture/blend.h"
#include "render/text/utf8.h"

namespace trapeze {
namespace {

// Hinted in height only: sharp rows, and widths proportional to the size.
constexpr FT_Int32 kLoadFlags = FT_LOAD_TARGET_LIGHT | FT_LOAD_NO_BITMAP;
constexpr std::string_view kEllipsis = "\u2026";

// In ems. Letters with marks above and below them are taller.
constexpr double kLineHeight = 1.2;
constexpr double kLineHeightOfMarks = 1.6;
constexpr int kMeasuredSize = 64;  // pixels: large enough for hinting to have no effect

struct CloseLibrary {
  void operator()(FT_Library library) const { FT_Done_FreeType(library); }
};
struct CloseFace {
  void operator()(FT_Face face) const { FT_Done_Face(face); }
};
struct DoneStroker {
  void operator()(FT_Stroker stroker) const { FT_Stroker_Done(stroker); }
};
struct DoneGlyph {
  void operator()(FT_Glyph glyph) const { FT_Done_Glyph(glyph); }
};
struct DestroyLayout {
  void operator()(raqm_t* layout) const { raqm_destroy(layout); }
};
using Library = std::unique_ptr<FT_LibraryRec_, CloseLibrary>;
using Face = std::unique_ptr<FT_FaceRec_, CloseFace>;
using Layout = std::unique_ptr<raqm_t, DestroyLayout>;
using Stroker = std::unique_ptr<FT_StrokerRec_, DoneStroker>;
using Glyph = std::unique_ptr<FT_GlyphRec_, DoneGlyph>;

Library open_library() {
  FT_Library library = nullptr;
  if (FT_Init_FreeType(&library) != 0) throw std::runtime_error("FreeType cannot be initialized");
  return Library(library);
}

/// A font in a file that may be a collection.
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

/// Whether a character belongs to the one before it.
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

/// A glyph at its position on the line; lengths are in 64ths of a pixel, y upwards.
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

/// Whether letters of the script are independent of each other except for kerning: Latin, Greek and
/// Cyrillic with their punctuation; Chinese, Japanese and Korean.
bool stands_for_itself(char32_t c) {
  return (c >= 0x20 && c < 0x300) || (c >= 0x370 && c < 0x483) || (c >= 0x48a && c < 0x530) ||
         (c >= 0x1e00 && c < 0x2000) || (c >= 0x2010 && c < 0x2028) ||
         (c >= 0x3000 && c < 0xa000) || (c >= 0xac00 && c < 0xd7a4);
}

/// Draws a bitmap into a mask; each value becomes the greater one.
void raise(const FT_Bitmap& bitmap, int left, int top, TextMask& mask,
           std::vector<std::uint8_t>& values) {
  for (int y = 0; y < static_cast<int>(bitmap.rows); ++y) {
    const unsigned char* row = bitmap.buffer + std::ptrdiff_t{y} * bitmap.pitch;
    if (top + y < 0 || top + y >= mask.height) continue;
    for (int x = 0; x < static_cast<int>(bitmap.width); ++x) {
      if (left + x < 0 || left + x >= mask.width) continue;
      auto& value =
          values[static_cast<std::size_t>(top + y) * static_cast<std::size_t>(mask.width) +
                 static_cast<std::size_t>(left + x)];
      value = std::max(value, row[x]);
    }
  }
}

/// Adds a glyph to the letters and, if there is a stroker, the glyph with its outline to the halo.
/// x and y, in 64ths of a pixel, y downwards, are the position of the glyph's origin in the mask.
void add_glyph(const PlacedGlyph& glyph, FT_Pos x, FT_Pos y, FT_Stroker stroker, TextMask& mask) {
  FT_GlyphSlot slot = glyph.face->glyph;
  if (FT_Load_Glyph(glyph.face, glyph.index, kLoadFlags) != 0) return;
  if (slot->format != FT_GLYPH_FORMAT_OUTLINE) return;
  const auto draw = [&](std::vector<std::uint8_t>& values, bool is_halo) {
    FT_Glyph copied = nullptr;
    if (FT_Get_Glyph(slot, &copied) != 0) return;
    Glyph drawn(copied);
    const auto replace = [&drawn](FT_Glyph made) {
      (void)drawn.release();
      drawn.reset(made);
    };
    if (is_halo) {
      FT_Glyph stroked = drawn.get();
      if (FT_Glyph_Stroke(&stroked, stroker, 1) != 0) return;
      replace(stroked);
    }
    const FT_Vector origin{x & 63, -(y & 63)};
    FT_Glyph rendered = drawn.get();
    if (FT_Glyph_To_Bitmap(&rendered, FT_RENDER_MODE_NORMAL, &origin, 1) != 0) return;
    replace(rendered);
    const auto* bitmap = reinterpret_cast<const FT_BitmapGlyphRec*>(drawn.get());
    raise(bitmap->bitmap, static_cast<int>(x >> 6) + bitmap->left,
          static_cast<int>(y >> 6) - bitmap->top, mask, values);
  };
  draw(mask.letters, false);
  if (stroker != nullptr) draw(mask.halo, true);
}

/// The longest prefix of at most that many bytes that does not end within a character.
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
    advances_.clear();
  }
  bool is_empty() const { return faces_.empty(); }

  std::string identity() const {
    int major = 0;
    int minor = 0;
    int patch = 0;
    FT_Library_Version(library_.get(), &major, &minor, &patch);
    std::string text = "FreeType " + std::to_string(major) + "." + std::to_string(minor) + "." +
                       std::to_string(patch) + ", HarfBuzz " + hb_version_string() + ", Raqm " +
                       raqm_version_string();
    for (const Face& face : faces_) {
      const auto* head = static_cast<const TT_Header*>(FT_Get_Sfnt_Table(face.get(), FT_SFNT_HEAD));
      text += std::string(", ") + (face->family_name == nullptr ? "" : face->family_name) + "/" +
              (face->style_name == nullptr ? "" : face->style_name) + "/" +
              std::to_string(face->num_glyphs) + "/" +
              std::to_string(head == nullptr ? 0 : head->CheckSum_Adjust);
    }
    return text;
  }

  /// Must be locked while faces are used.
  std::unique_lock<std::mutex> lock() { return std::unique_lock(mutex_); }

  ShapedLine shape(std::string_view line, double size) {
    return shape(characters_of_line(line, kMostCharacters), size);
  }

  ShapedLine shape(const std::u32string& text, double size) {
    if (text.empty() || is_empty()) return {};
    set_size(std::clamp<FT_F26Dot6>(std::lround(size * 64), 64, kMostTextSize * 64));
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

  /// A stroker for a halo of that width, in pixels.
  Stroker stroker(double width) {
    FT_Stroker made = nullptr;
    if (FT_Stroker_New(library_.get(), &made) != 0) throw std::bad_alloc();
    FT_Stroker_Set(made, std::lround(width * 64), FT_STROKER_LINECAP_ROUND,
                   FT_STROKER_LINEJOIN_ROUND, 0);
    return Stroker(made);
  }

  Extent extent_of(std::string_view line) {
    const std::u32string text = characters_of_line(line, kMostCharacters);
    if (text.empty() || is_empty()) return {0, kLineHeight};
    if (!std::ranges::all_of(text, stands_for_itself)) {
      return {static_cast<double>(shape(text, kMeasuredSize).width) / 64 / kMeasuredSize,
              kLineHeightOfMarks};
    }
    double width = 0;
    for (const char32_t c : text) width += advance_of(c);
    return {width, kLineHeight};
  }

  bool can_write(std::string_view line) const {
    const std::u32string text = characters_of_line(line, kMostCharacters);
    std::size_t begin = 0;
    while (begin < text.size()) {
      const std::size_t end = end_of_cluster(text, begin);
      if (find_face_for(text, begin, end) == nullptr) return false;
      begin = end;
    }
    return true;
  }

 private:
  /// In 64ths of a pixel.
  void set_size(FT_F26Dot6 size) {
    if (size == size_) return;
    for (const Face& face : faces_) FT_Set_Char_Size(face.get(), 0, size, 72, 72);
    size_ = size;
  }

  /// In ems.
  double advance_of(char32_t c) {
    const auto found = advances_.find(c);
    if (found != advances_.end()) return found->second;
    const std::u32string text(1, c);
    FT_Face face = face_for(text, 0, 1);
    const bool is_known = FT_Load_Glyph(face, FT_Get_Char_Index(face, c), FT_LOAD_NO_SCALE) == 0 &&
                          face->units_per_EM > 0;
    const double ems =
        is_known ? static_cast<double>(face->glyph->advance.x) / face->units_per_EM : 0;
    advances_.emplace(c, ems);
    return ems;
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

  /// The end of a character with its marks.
  static std::size_t end_of_cluster(const std::u32string& text, std::size_t begin) {
    std::size_t end = begin + 1;
    while (end < text.size() && following_of(text[end]) != Following::none) ++end;
    return end;
  }

  /// The first face that has the whole cluster; null if none has.
  FT_Face find_face_for(const std::u32string& text, std::size_t begin, std::size_t end) const {
    const auto has_all = [&](const Face& face) {
      const auto is_there = [&](char32_t c) {
        return following_of(c) == Following::joiner || has(face.get(), c);
      };
      return std::all_of(text.begin() + static_cast<std::ptrdiff_t>(begin),
                         text.begin() + static_cast<std::ptrdiff_t>(end), is_there);
    };
    const auto found = std::ranges::find_if(faces_, has_all);
    return found == faces_.end() ? nullptr : found->get();
  }

  /// The same, or else the first face that has the first character, or else the first face.
  FT_Face face_for(const std::u32string& text, std::size_t begin, std::size_t end) const {
    if (FT_Face found = find_face_for(text, begin, end)) return found;
    const auto has_first = [&](const Face& face) { return has(face.get(), text[begin]); };
    const auto found = std::ranges::find_if(faces_, has_first);
    return (found == faces_.end() ? faces_.front() : *found).get();
  }

  std::mutex mutex_;
  Library library_ = open_library();  // must outlive the faces
  std::vector<Face> faces_;
  FT_F26Dot6 size_ = 0;                            // of all faces; 0: not set yet
  std::unordered_map<char32_t, double> advances_;  // in ems, for independent letters
};

Fonts::Fonts() : faces_(std::make_unique<Faces>()) {}
Fonts::~Fonts() = default;

void Fonts::add(const std::string& file) {
  faces_->add(file);
}

bool Fonts::is_empty() const {
  return faces_->is_empty();
}

std::string Fonts::identity() const {
  return faces_->identity();
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

Fonts::Extent Fonts::extent_of(std::string_view line) const {
  const auto lock = faces_->lock();
  return faces_->extent_of(line);
}

bool Fonts::can_write(std::string_view line) const {
  const auto lock = faces_->lock();
  return faces_->can_write(line);
}

TextMask Fonts::mask_of(std::span<const std::string> lines, double size, double line_height,
                        double halo, int width, int height) const {
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  TextMask mask{width, height, std::vector<std::uint8_t>(pixels), {}};
  mask.halo = mask.letters;
  // The middle of a line is halfway between the baseline and the top of capitals: about 0.36 ems
  // above the baseline in the fonts of most scripts.
  constexpr double kMiddle = 0.36;
  double base =
      height / 2.0 - line_height * (static_cast<double>(lines.size()) - 1) / 2 + kMiddle * size;
  const auto lock = faces_->lock();
  const Stroker stroker = halo > 0 ? faces_->stroker(halo) : nullptr;
  for (const std::string& line : lines) {
    const ShapedLine shaped = faces_->shape(line, size);
    const FT_Pos left = FT_Pos{width} * 32 - shaped.width / 2;
    const auto whole_base = static_cast<FT_Pos>(std::lround(base)) * 64;
    for (const PlacedGlyph& glyph : shaped.glyphs) {
      add_glyph(glyph, left + glyph.x, whole_base - glyph.y, stroker.get(), mask);
    }
    base += line_height;
  }
  // In a few steps, so that pictures have few colours.
  const auto in_steps = [](std::uint8_t value) {
    constexpr int kStep = 17;
    return static_cast<std::uint8_t>((value + kStep / 2) / kStep * kStep);
  };
  for (std::size_t i = 0; i < pixels; ++i) {
    mask.letters[i] = in_steps(mask.letters[i]);
    mask.halo[i] = std::max(in_steps(mask.halo[i]), mask.letters[i]);
  }
  return mask;
}

}  // namespace trapeze
