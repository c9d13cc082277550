#include "server/styles/label_template.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <type_traits>
#include <utility>
#include <variant>

#include "server/base/problem.h"
#include "server/styles/filter.h"

namespace trapeze {
namespace {

std::string words_of(const Value& value, const std::optional<NumberFormat>& format) {
  return std::visit(
      [&format](const auto& each) -> std::string {
        using Type = std::decay_t<decltype(each)>;
        if constexpr (std::is_same_v<Type, std::monostate>) {
          return {};
        } else if constexpr (std::is_same_v<Type, std::string_view>) {
          return std::string(each);
        } else {
          const auto number = static_cast<double>(each);
          if (std::isnan(number)) return {};
          if (format && std::isfinite(number)) return formatted(number, *format);
          return fmt::format("{}", each + Type());  // without the sign of negative zero
        }
      },
      value);
}

/// Reduces white space and control characters to single spaces, with none at the ends. Bytes that
/// are not valid UTF-8 are left to the code that draws the text.
std::string tidied(std::string_view text) {
  std::string tidy;
  std::size_t letters = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= 0x20 || byte == 0x7f) {
      if (!tidy.empty() && tidy.back() != ' ') tidy += ' ';
      continue;
    }
    if ((byte & 0xc0) != 0x80 && ++letters > LabelTemplate::kMostLetters) {
      tidy += "\u2026";
      break;
    }
    tidy += c;
  }
  if (!tidy.empty() && tidy.back() == ' ') tidy.pop_back();
  return tidy;
}

/// Calls found(is_name, text) for each piece; false if the text is not valid.
template <typename Found>
bool for_each_piece(std::string_view text, const Found& found) {
  if (text.find_first_of("{}") == std::string_view::npos) {
    if (text.empty()) return false;
    found(true, text);
    return true;
  }
  bool has_name = false;
  while (!text.empty()) {
    const std::size_t open = text.find_first_of("{}");
    if (open == std::string_view::npos) {
      found(false, text);
      break;
    }
    if (text[open] == '}') return false;
    if (open > 0) found(false, text.substr(0, open));
    const std::size_t close = text.find_first_of("{}", open + 1);
    if (close == std::string_view::npos || text[close] == '{' || close == open + 1) return false;
    found(true, text.substr(open + 1, close - open - 1));
    has_name = true;
    text.remove_prefix(close + 1);
  }
  return has_name;
}

bool says_something(std::string_view words) {
  return words.find_first_not_of(' ') != std::string_view::npos;
}

}  // namespace

bool LabelTemplate::is_valid(std::string_view text) {
  return for_each_piece(text, [](bool, std::string_view) {});
}

Result<LabelTemplate> LabelTemplate::bind(std::string_view text, const Attributes& attributes,
                                          std::string_view language) {
  LabelTemplate made;
  std::optional<Problem> problem;
  for_each_piece(text, [&](bool is_name, std::string_view piece) {
    if (!is_name) {
      made.pieces_.push_back({std::string(piece)});
      return;
    }
    const int number = attributes.field_index(piece);
    if (number < 0 && !problem) {
      problem = unknown_property("label", std::string(piece), attributes);
    }
    int translation = -1;
    for (const char* parting : {":", "_"}) {
      if (language.empty() || translation >= 0) continue;
      translation = attributes.field_index(fmt::format("{}{}{}", piece, parting, language));
    }
    made.pieces_.push_back({{}, number, translation});
  });
  if (problem) return *std::move(problem);
  return made;
}

template <typename ValueOf>
std::string LabelTemplate::text_of(const std::optional<NumberFormat>& format,
                                   const ValueOf& value_of) const {
  std::string text;
  bool says_anything = false;
  for (const Piece& piece : pieces_) {
    if (piece.attribute < 0) {
      text += piece.text;
      continue;
    }
    const std::string words = words_of(value_of(piece), format);
    says_anything |= says_something(words);
    text += words;
  }
  return says_anything ? tidied(text) : std::string();
}

std::string LabelTemplate::text_of(const Attributes& attributes, std::uint32_t row,
                                   const std::optional<NumberFormat>& format) const {
  return text_of(format,
                 [&](const Piece& piece) { return attributes.value(row, piece.attribute); });
}

std::string LabelTemplate::translation_of(const Attributes& attributes,
                                          const JoinedValues* translated, std::uint32_t row,
                                          const std::optional<NumberFormat>& format) const {
  return text_of(format, [&](const Piece& piece) {
    Value value;
    if (piece.attribute == attributes.joined_index() && translated != nullptr) {
      value = translated->value(row);
    } else if (piece.translation >= 0) {
      value = attributes.value(row, piece.translation);
    }
    return says_something(words_of(value, format)) ? value : attributes.value(row, piece.attribute);
  });
}

}  // namespace trapeze
