#include "render/picture/colour.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace trapeze {
namespace {

struct NamedColour {
  std::string_view name;
  std::uint32_t rgb;
};

// CSS Color Module Level 4, 6.1; sorted by name.
constexpr std::array<NamedColour, 148> kNamedColours{{
    {"aliceblue", 0xf0f8ff},
    {"antiquewhite", 0xfaebd7},
    {"aqua", 0x00ffff},
    {"aquamarine", 0x7fffd4},
    {"azure", 0xf0ffff},
    {"beige", 0xf5f5dc},
    {"bisque", 0xffe4c4},
    {"black", 0x000000},
    {"blanchedalmond", 0xffebcd},
    {"blue", 0x0000ff},
    {"blueviolet", 0x8a2be2},
    {"brown", 0xa52a2a},
    {"burlywood", 0xdeb887},
    {"cadetblue", 0x5f9ea0},
    {"chartreuse", 0x7fff00},
    {"chocolate", 0xd2691e},
    {"coral", 0xff7f50},
    {"cornflowerblue", 0x6495ed},
    {"cornsilk", 0xfff8dc},
    {"crimson", 0xdc143c},
    {"cyan", 0x00ffff},
    {"darkblue", 0x00008b},
    {"darkcyan", 0x008b8b},
    {"darkgoldenrod", 0xb8860b},
    {"darkgray", 0xa9a9a9},
    {"darkgreen", 0x006400},
    {"darkgrey", 0xa9a9a9},
    {"darkkhaki", 0xbdb76b},
    {"darkmagenta", 0x8b008b},
    {"darkolivegreen", 0x556b2f},
    {"darkorange", 0xff8c00},
    {"darkorchid", 0x9932cc},
    {"darkred", 0x8b0000},
    {"darksalmon", 0xe9967a},
    {"darkseagreen", 0x8fbc8f},
    {"darkslateblue", 0x483d8b},
    {"darkslategray", 0x2f4f4f},
    {"darkslategrey", 0x2f4f4f},
    {"darkturquoise", 0x00ced1},
    {"darkviolet", 0x9400d3},
    {"deeppink", 0xff1493},
    {"deepskyblue", 0x00bfff},
    {"dimgray", 0x696969},
    {"dimgrey", 0x696969},
    {"dodgerblue", 0x1e90ff},
    {"firebrick", 0xb22222},
    {"floralwhite", 0xfffaf0},
    {"forestgreen", 0x228b22},
    {"fuchsia", 0xff00ff},
    {"gainsboro", 0xdcdcdc},
    {"ghostwhite", 0xf8f8ff},
    {"gold", 0xffd700},
    {"goldenrod", 0xdaa520},
    {"gray", 0x808080},
    {"green", 0x008000},
    {"greenyellow", 0xadff2f},
    {"grey", 0x808080},
    {"honeydew", 0xf0fff0},
    {"hotpink", 0xff69b4},
    {"indianred", 0xcd5c5c},
    {"indigo", 0x4b0082},
    {"ivory", 0xfffff0},
    {"khaki", 0xf0e68c},
    {"lavender", 0xe6e6fa},
    {"lavenderblush", 0xfff0f5},
    {"lawngreen", 0x7cfc00},
    {"lemonchiffon", 0xfffacd},
    {"lightblue", 0xadd8e6},
    {"lightcoral", 0xf08080},
    {"lightcyan", 0xe0ffff},
    {"lightgoldenrodyellow", 0xfafad2},
    {"lightgray", 0xd3d3d3},
    {"lightgreen", 0x90ee90},
    {"lightgrey", 0xd3d3d3},
    {"lightpink", 0xffb6c1},
    {"lightsalmon", 0xffa07a},
    {"lightseagreen", 0x20b2aa},
    {"lightskyblue", 0x87cefa},
    {"lightslategray", 0x778899},
    {"lightslategrey", 0x778899},
    {"lightsteelblue", 0xb0c4de},
    {"lightyellow", 0xffffe0},
    {"lime", 0x00ff00},
    {"limegreen", 0x32cd32},
    {"linen", 0xfaf0e6},
    {"magenta", 0xff00ff},
    {"maroon", 0x800000},
    {"mediumaquamarine", 0x66cdaa},
    {"mediumblue", 0x0000cd},
    {"mediumorchid", 0xba55d3},
    {"mediumpurple", 0x9370db},
    {"mediumseagreen", 0x3cb371},
    {"mediumslateblue", 0x7b68ee},
    {"mediumspringgreen", 0x00fa9a},
    {"mediumturquoise", 0x48d1cc},
    {"mediumvioletred", 0xc71585},
    {"midnightblue", 0x191970},
    {"mintcream", 0xf5fffa},
    {"mistyrose", 0xffe4e1},
    {"moccasin", 0xffe4b5},
    {"navajowhite", 0xffdead},
    {"navy", 0x000080},
    {"oldlace", 0xfdf5e6},
    {"olive", 0x808000},
    {"olivedrab", 0x6b8e23},
    {"orange", 0xffa500},
    {"orangered", 0xff4500},
    {"orchid", 0xda70d6},
    {"palegoldenrod", 0xeee8aa},
    {"palegreen", 0x98fb98},
    {"paleturquoise", 0xafeeee},
    {"palevioletred", 0xdb7093},
    {"papayawhip", 0xffefd5},
    {"peachpuff", 0xffdab9},
    {"peru", 0xcd853f},
    {"pink", 0xffc0cb},
    {"plum", 0xdda0dd},
    {"powderblue", 0xb0e0e6},
    {"purple", 0x800080},
    {"rebeccapurple", 0x663399},
    {"red", 0xff0000},
    {"rosybrown", 0xbc8f8f},
    {"royalblue", 0x4169e1},
    {"saddlebrown", 0x8b4513},
    {"salmon", 0xfa8072},
    {"sandybrown", 0xf4a460},
    {"seagreen", 0x2e8b57},
    {"seashell", 0xfff5ee},
    {"sienna", 0xa0522d},
    {"silver", 0xc0c0c0},
    {"skyblue", 0x87ceeb},
    {"slateblue", 0x6a5acd},
    {"slategray", 0x708090},
    {"slategrey", 0x708090},
    {"snow", 0xfffafa},
    {"springgreen", 0x00ff7f},
    {"steelblue", 0x4682b4},
    {"tan", 0xd2b48c},
    {"teal", 0x008080},
    {"thistle", 0xd8bfd8},
    {"tomato", 0xff6347},
    {"turquoise", 0x40e0d0},
    {"violet", 0xee82ee},
    {"wheat", 0xf5deb3},
    {"white", 0xffffff},
    {"whitesmoke", 0xf5f5f5},
    {"yellow", 0xffff00},
    {"yellowgreen", 0x9acd32},
}};

constexpr bool is_in_order() {
  for (std::size_t i = 1; i < kNamedColours.size(); ++i) {
    if (!(kNamedColours[i - 1].name < kNamedColours[i].name)) return false;
  }
  return true;
}
static_assert(is_in_order(), "names are found by halving");

constexpr std::size_t kLongestText = 128;  // longer texts are not colours

constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f';
}

// ASCII letters only, whatever the locale.
constexpr char to_lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
}

std::string_view strip(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

std::optional<Rgba> parse_hex(std::string_view text) {
  if (text.size() != 3 && text.size() != 4 && text.size() != 6 && text.size() != 8) return {};
  std::array<int, 8> digits{};
  for (std::size_t i = 0; i < text.size(); ++i) {
    digits[i] = hex_digit(text[i]);
    if (digits[i] < 0) return {};
  }
  std::array<std::uint8_t, 4> channels{0, 0, 0, 255};
  const bool is_short = text.size() <= 4;
  for (std::size_t i = 0; i < (is_short ? text.size() : text.size() / 2); ++i) {
    channels[i] = static_cast<std::uint8_t>(is_short ? digits[i] * 17
                                                     : digits[2 * i] * 16 + digits[2 * i + 1]);
  }
  return Rgba{channels[0], channels[1], channels[2], channels[3]};
}

std::optional<Rgba> parse_name(std::string_view text) {
  if (text == "transparent" || text == "none") return kTransparent;
  const auto found = std::lower_bound(
      kNamedColours.begin(), kNamedColours.end(), text,
      [](const NamedColour& colour, std::string_view name) { return colour.name < name; });
  if (found == kNamedColours.end() || found->name != text) return {};
  return Rgba{static_cast<std::uint8_t>(found->rgb >> 16),
              static_cast<std::uint8_t>(found->rgb >> 8), static_cast<std::uint8_t>(found->rgb),
              255};
}

std::uint8_t to_channel(double share) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(share, 0.0, 1.0) * 255.0));
}

// Parses the arguments of rgb() one by one.
class Arguments {
 public:
  explicit Arguments(std::string_view text) : rest_(text) {}

  struct Number {
    double value;
    bool is_percentage;
  };

  std::optional<Number> take_number() {
    skip_blanks();
    if (!rest_.empty() && rest_.front() == '+') {
      rest_.remove_prefix(1);
      if (!rest_.empty() && rest_.front() == '-') return {};
    }
    double value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc() || !std::isfinite(value)) return {};
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return Number{value, take('%')};
  }

  // Consumes the character, with spaces around it, if it comes next.
  bool take_separator(char c) {
    const std::string_view before = rest_;
    skip_blanks();
    if (take(c)) return true;
    rest_ = before;
    return false;
  }

  bool skip_blanks() {
    const std::size_t size = rest_.size();
    while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
    return rest_.size() != size;
  }

  bool is_at_end() {
    skip_blanks();
    return rest_.empty();
  }

 private:
  bool take(char c) {
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }

  std::string_view rest_;
};

std::optional<Rgba> parse_arguments(std::string_view text) {
  Arguments arguments(text);
  std::array<Arguments::Number, 3> numbers{};
  bool has_commas = false;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i == 1) has_commas = arguments.take_separator(',');
    if (i == 1 && !has_commas && !arguments.skip_blanks()) return {};
    if (i == 2 && !(has_commas ? arguments.take_separator(',') : arguments.skip_blanks()))
      return {};
    const auto number = arguments.take_number();
    if (!number || (i > 0 && number->is_percentage != numbers[0].is_percentage)) return {};
    numbers[i] = *number;
  }
  double opacity = 1;
  if (arguments.take_separator(has_commas ? ',' : '/')) {
    const auto number = arguments.take_number();
    if (!number) return {};
    opacity = number->is_percentage ? number->value / 100 : number->value;
  }
  if (!arguments.is_at_end()) return {};
  const double whole = numbers[0].is_percentage ? 100 : 255;
  return Rgba{to_channel(numbers[0].value / whole), to_channel(numbers[1].value / whole),
              to_channel(numbers[2].value / whole), to_channel(opacity)};
}

std::optional<Rgba> parse_function(std::string_view text) {
  for (const std::string_view head : {"rgb(", "rgba("}) {
    if (text.substr(0, head.size()) == head && text.back() == ')') {
      return parse_arguments(text.substr(head.size(), text.size() - head.size() - 1));
    }
  }
  return {};
}

}  // namespace

std::optional<Rgba> parse_colour(std::string_view text) {
  if (text.size() > kLongestText) return {};
  std::string lower(strip(text));
  std::transform(lower.begin(), lower.end(), lower.begin(), to_lower);
  if (lower.empty()) return {};
  if (lower.front() == '#') return parse_hex(std::string_view(lower).substr(1));
  if (const auto colour = parse_hex(lower)) return colour;
  if (const auto colour = parse_name(lower)) return colour;
  return parse_function(lower);
}

std::string to_hex(Rgba colour) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t channel : {colour.r, colour.g, colour.b, colour.a}) {
    text += kDigits[channel >> 4];
    text += kDigits[channel & 15];
  }
  return text;
}

Rgba with_opacity(Rgba colour, double opacity) {
  colour.a = to_channel(colour.a / 255.0 * opacity);
  return colour;
}

}  // namespace trapeze
