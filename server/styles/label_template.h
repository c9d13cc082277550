// What a label says of a feature: text with attributes in it.
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

/// "{NAME} ({A3})": the names of attributes in braces, and what stands around them. Text without
/// braces is the name of an attribute.
class LabelTemplate {
 public:
  /// Whether each brace has its counterpart, and none of the names is empty.
  static bool is_valid(std::string_view text);

  /// Looks for the attributes, and for those that say the same in a language: NAME:LANGUAGE or
  /// NAME_LANGUAGE. `text` is valid. The problem, 400, is a name that there is not.
  static Result<LabelTemplate> bind(std::string_view text, const Attributes& attributes,
                                    std::string_view language = {});

  /// What it says of the feature in that row: attributes that are null say nothing. Numbers are
  /// written by the format, or else with as many digits as it takes. Empty if none of the
  /// attributes says anything. White space is one space each, none at the ends, and what is longer
  /// than kMostLetters ends in an ellipsis.
  std::string text_of(const Attributes& attributes, std::uint32_t row,
                      const std::optional<NumberFormat>& format) const;
  /// The same in the language, where something is known in it. `translated`: the joined values in
  /// it; null: there are none.
  std::string translation_of(const Attributes& attributes, const JoinedValues* translated,
                             std::uint32_t row, const std::optional<NumberFormat>& format) const;

  static constexpr std::size_t kMostLetters = 200;

 private:
  struct Piece {
    std::string text;
    int attribute = -1;    // number; -1: it is text
    int translation = -1;  // of the attribute that says the same in the language; -1: there is none
  };
  template <typename ValueOf>
  std::string text_of(const std::optional<NumberFormat>& format, const ValueOf& value_of) const;

  std::vector<Piece> pieces_;
};

}  // namespace trapeze
