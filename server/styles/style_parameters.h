// The query parameters that style a tile: a single table from which the parser, the canonical form,
// the error bodies, the OpenAPI document and the table of docs/styling.md are derived.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "render/picture/colour.h"
#include "server/base/result.h"
#include "server/base/url.h"
#include "server/styles/filter.h"
#include "server/values/class_breaks.h"
#include "server/values/number_format.h"
#include "server/values/value_table.h"

namespace trapeze {

/// In the order of the table, which is sorted by name.
enum class ParameterId : std::uint8_t {
  background,
  breaks,
  classes,
  color_by,
  debug,
  fill,
  fill_opacity,
  filter,
  grow,
  highlight,
  highlight_fill,
  highlight_stroke,
  ids,
  join,
  label,
  label_color,
  label_font,
  label_format,
  label_halo_color,
  label_halo_width,
  label_language,
  label_max_width,
  label_min_size,
  label_overhang,
  label_parts,
  label_priority,
  label_repeat,
  label_size,
  merge,
  no_data_color,
  opacity,
  pattern,
  pattern_angle,
  pattern_color,
  pattern_size,
  pattern_width,
  quality,
  ramp,
  simplify,
  small,
  smooth,
  stroke,
  stroke_dasharray,
  stroke_linejoin,
  stroke_opacity,
  stroke_width,
  style,
  topology,
  units,
  values,
};

enum class ParameterType : std::uint8_t {
  colour,
  number,
  numbers,   // separated by commas
  breaks,    // numbers, each greater than the one before, or a BreakRule
  word,      // one of StyleParameter::words
  words,     // some of them, separated by commas, in any order
  name,      // of an attribute
  ramp,      // the name of a colour ramp
  ids,       // integers, separated by commas, in any order
  classes,   // value:colour, separated by commas
  filter,    // CQL2 text
  style,     // the name of a style
  format,    // a NumberFormat
  text,      // a few words
  table,     // the name or id of a ValueTable
  label,     // a LabelTemplate
  font,      // the name of a font
  language,  // see is_language_tag()
};

struct StyleParameter {
  ParameterId id;
  std::string_view name;
  ParameterType type;
  double min = 0;  // of a number, or of each number of a list
  double max = 0;
  std::size_t max_items = 0;                     // in a list
  std::span<const std::string_view> words = {};  // in alphabetical order
  std::string_view default_text = {};            // as words
  bool is_per_layer = true;                      // may also be written layer.name=
  std::string_view description = {};
};

/// One class of features, by the value of an attribute. Values are text until the attribute is
/// known.
struct ColourClass {
  enum class Kind : std::uint8_t {
    value,
    null,    // no value; written null
    others,  // not in any class; written *
  };
  Kind kind = Kind::value;
  std::string value;
  Rgba colour;

  friend bool operator==(const ColourClass&, const ColourClass&) = default;
};

/// A table by its name or id, and the table itself once it was found among the posted ones.
struct TableChoice {
  std::string name;
  std::shared_ptr<const ValueTable> table = {};

  friend bool operator==(const TableChoice& a, const TableChoice& b) { return a.name == b.name; }
};

/// Words are in the order of the table, without duplicates, separated by commas; ids are ascending,
/// without duplicates.
using ParameterValue =
    std::variant<Rgba, double, std::string, std::vector<double>, std::vector<std::int64_t>,
                 std::vector<ColourClass>, std::shared_ptr<const Filter>, BreakRule, NumberFormat,
                 TableChoice>;

/// The parameters that requests can set, sorted by name.
std::span<const StyleParameter> style_parameters();
const StyleParameter& style_parameter(ParameterId id);
/// Whether it is one of the parameters that put features into classes by an attribute.
bool is_classing_parameter(ParameterId id);
/// Null if there is no parameter of that name.
const StyleParameter* find_style_parameter(std::string_view name);

/// Nothing if `text` is not a valid value of the parameter.
std::optional<ParameterValue> parse_parameter(const StyleParameter& parameter,
                                              std::string_view text);
/// The canonical text, which parse_parameter() parses as the same value.
std::string format_value(const ParameterValue& value);
/// For example "a number from 0 to 1".
std::string describe_values(const StyleParameter& parameter);

/// A name that any query may contain, with any value, to make a URL unique for caches.
constexpr std::string_view kFreeParameter = "_";

/// One parameter set by a request, for all layers (`layer` empty) or for one.
struct StyleSetting {
  std::string layer;
  ParameterId parameter;
  ParameterValue value;
  bool is_configured = false;  // in a named style by the operator, who may set what is locked
};

/// The style set by a query: settings in the order (layer, parameter), each at most once. Named
/// styles come from a StyleBook and are added by over().
class StyleQuery {
 public:
  StyleQuery() = default;

  /// A problem, 400, is a name that is neither PARAMETER nor LAYER.PARAMETER for one of `layers`,
  /// nor one of `others`, which are read elsewhere; a parameter that is given twice; or an invalid
  /// value. `style` and kFreeParameter are ignored.
  static Result<StyleQuery> parse(std::span<const QueryPair> pairs,
                                  std::span<const std::string> layers,
                                  std::span<const std::string_view> others = {});

  std::span<const StyleSetting> settings() const { return settings_; }
  /// The value for `layer`: its own setting, else the one for all layers, else null. Classes for
  /// all layers are not for one with breaks or a ramp of its own, nor the other way round.
  const ParameterValue* find(std::string_view layer, ParameterId parameter) const;
  std::optional<ParameterValue> value_for(std::string_view layer, ParameterId parameter) const;
  /// This style for one layer, completed from `defaults`, which are for all layers. Rules that put
  /// features into classes are taken as a whole or not at all.
  StyleQuery with_defaults(const std::string& layer, const StyleQuery& defaults) const;
  /// This style, completed with what `style` sets for all layers or for one of `layers`. A setting
  /// here for all layers does not override one of `style` for a single layer. Rules that put
  /// features into classes are taken as a whole or not at all.
  StyleQuery over(const StyleQuery& style, std::span<const std::string> layers) const;
  /// What this style sets for `layer`, as settings of that layer alone, and for the whole picture.
  StyleQuery of_layer(const std::string& layer) const;
  /// This style without settings for one layer that `query` sets for that layer or for all. Rules
  /// that put features into classes are taken as a whole or not at all.
  StyleQuery without_those_of(const StyleQuery& query) const;
  /// The same with the tables that `find` returns for the table names in settings; it returns null
  /// for an unknown name.
  using FindTable = std::function<std::shared_ptr<const ValueTable>(const std::string& name)>;
  StyleQuery with_tables(const FindTable& find) &&;
  /// The same as a style that the operator has configured.
  StyleQuery configured() &&;
  /// The settings as query pairs, not percent-encoded.
  std::vector<QueryPair> pairs() const;
  /// The canonical query string: equal styles that are written differently give the same text.
  std::string canonical_text() const;

 private:
  const StyleSetting* find_setting(std::string_view layer, ParameterId parameter) const;
  /// Whether the layer puts features into classes by a rule of its own that excludes the parameter.
  bool is_excluded(std::string_view layer, ParameterId parameter) const;
  /// Whether it contains that setting or, if that is one of the rules for classes, any such rule
  /// for that layer.
  bool sets(const StyleSetting& setting) const;

  std::vector<StyleSetting> settings_;
};

}  // namespace trapeze
