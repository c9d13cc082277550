// The query parameters that style a tile: one table from which the parser, the canonical form and
// the error bodies come.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "render/colour.h"
#include "server/problem.h"
#include "server/url.h"

namespace trapeze {

/// In the order of the table, which is the order of names.
enum class ParameterId : std::uint8_t {
  background,
  debug,
  fill,
  fill_opacity,
  simplify,
  small,
  topology,
};

enum class ParameterType : std::uint8_t {
  colour,
  number,
  word,   // one of StyleParameter::words
  words,  // some of them, separated by commas, in any order
};

struct StyleParameter {
  ParameterId id;
  std::string_view name;
  ParameterType type;
  double min;  // of a number
  double max;
  std::string_view words;         // separated by spaces, in alphabetical order
  std::string_view default_text;  // in words
  bool is_per_layer;              // may be written layer.name= too
  std::string_view description;
};

/// Words are in the order of the table, each once, separated by commas.
using ParameterValue = std::variant<Rgba, double, std::string>;

std::span<const StyleParameter> style_parameters();
const StyleParameter& style_parameter(ParameterId id);
/// Null if there is none of that name.
const StyleParameter* find_style_parameter(std::string_view name);

/// Nothing if `text` is not what the parameter takes.
std::optional<ParameterValue> parse_parameter(const StyleParameter& parameter,
                                              std::string_view text);
/// "a number from 0 to 1".
std::string describe_values(const StyleParameter& parameter);

/// One parameter set by a request, for all layers (`layer` empty) or for one.
struct StyleSetting {
  std::string layer;
  ParameterId parameter;
  ParameterValue value;

  friend bool operator==(const StyleSetting&, const StyleSetting&) = default;
};

/// The style that a query asks for: settings in the order (layer, parameter), each at most once.
class StyleQuery {
 public:
  StyleQuery() = default;

  /// Names that are not in the table, or belong to a layer that is not in `layers`, are ignored.
  /// A parameter given twice, or set to what it does not take, is a problem.
  static OrProblem<StyleQuery> parse(std::span<const QueryPair> pairs,
                                     std::span<const std::string> layers);

  std::span<const StyleSetting> settings() const { return settings_; }
  /// What holds for `layer`: its own setting, else the one for all layers, else nothing.
  std::optional<ParameterValue> value_for(std::string_view layer, ParameterId parameter) const;
  /// The canonical query string: equal styles written differently give the same text.
  std::string canonical_text() const;

 private:
  const StyleSetting* find(std::string_view layer, ParameterId parameter) const;

  std::vector<StyleSetting> settings_;
};

}  // namespace trapeze
