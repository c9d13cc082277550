// The text of labels: a template that contains attributes.
//
// Thread-safety: any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"
#include "server/values/attributes.h"
#include "server/values/number_format.h"

namespace trapeze {

/// For example "{NAME} ({A3})": names of attributes in braces, with text around them. Text without
/// braces is the name of an attribute.
class LabelTemplate {
 public:
  /// Whether all braces are balanced and no name is empty.
  static bool is_valid(std::string_view text);

  /// Finds the attributes, and their translations in a language: NAME:LANGUAGE or NAME_LANGUAGE.
  /// `text` must be valid. The problem, 400, reports a name that does not exist.
  static Result<LabelTemplate> bind(std::string_view text, const Attributes& attributes,
                                    std::string_view language = {});

  /// The text for the feature in that row; null attributes are left out. Numbers are written in the
  /// given format, or else with as many digits as needed. Empty if all attributes are null. White
  /// space is reduced to single spaces, without any at the ends; text longer than kMostLetters is
  /// cut and ends with an ellipsis.
  std::string text_of(const Attributes& attributes, std::uint32_t row,
                      const std::optional<NumberFormat>& format) const;
  /// The text with translations into the language where they are known. `translated`: the joined
  /// values in that language; null: none.
  std::string translation_of(const Attributes& attributes, const JoinedValues* translated,
                             std::uint32_t row, const std::optional<NumberFormat>& format) const;

  static constexpr std::size_t kMostLetters = 200;

 private:
  struct Piece {
    std::string text;
    int attribute = -1;    // index; -1: fixed text
    int translation = -1;  // index of the translated attribute; -1: none
  };
  template <typename ValueOf>
  std::string text_of(const std::optional<NumberFormat>& format, const ValueOf& value_of) const;

  std::vector<Piece> pieces_;
};

}  // namespace trapeze
