#include "server/styles/style_parameters.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <tuple>

#include "core/graph/topology.h"
#include "core/layer/layer.h"
#include "core/layer/layer_options.h"
#include "render/mask/stroke.h"
#include "render/picture/pattern.h"
#include "render/picture/reduce_colours.h"
#include "server/base/language_tag.h"
#include "server/base/nearest_name.h"
#include "server/styles/colour_ramps.h"
#include "server/styles/debug_marks.h"
#include "server/styles/label_template.h"

namespace trapeze {
namespace {

// The maximum tolerance of a request: half the side of a tile would leave nothing.
constexpr double kMaxSimplify = 64;
constexpr std::size_t kMaxClasses = 253;  // by value; with two more and "not drawn", fits a byte
constexpr std::size_t kMaxBreaks = 63;
constexpr std::size_t kMaxIds = 256;
constexpr std::size_t kMaxNameLength = 128;
constexpr std::size_t kMaxTextLength = 32;
constexpr std::size_t kMaxTemplateLength = 200;
constexpr std::array<std::string_view, 2> kLabelPartsWords = {"all", "largest"};
constexpr std::array<std::string_view, 2> kYesOrNoWords = {"no", "yes"};

using Type = ParameterType;

// These are only meaningful together.
constexpr std::array kClassingParameters = {ParameterId::breaks, ParameterId::classes,
                                            ParameterId::color_by, ParameterId::ramp};

constexpr std::array kParameters = {
    StyleParameter{.id = ParameterId::background,
                   .name = "background",
                   .type = Type::colour,
                   .default_text = "transparent",
                   .is_per_layer = false,
                   .description = "background colour of the tile"},
    StyleParameter{.id = ParameterId::breaks,
                   .name = "breaks",
                   .type = Type::breaks,
                   .min = -1e300,
                   .max = 1e300,
                   .max_items = kMaxBreaks,
                   .default_text = "no classes",
                   .description = "class breaks for a numeric color-by attribute: a number belongs "
                                  "to the class above the last break that it reaches; or a rule "
                                  "that computes the breaks from all values of the layer"},
    StyleParameter{.id = ParameterId::classes,
                   .name = "classes",
                   .type = Type::classes,
                   .max_items = kMaxClasses,
                   .default_text = "no classes",
                   .description = "colours for the values of color-by; * matches all other values, "
                                  "which otherwise keep the fill; null matches missing values"},
    StyleParameter{
        .id = ParameterId::color_by,
        .name = "color-by",
        .type = Type::name,
        .default_text = "no classes",
        .description =
            "attribute that determines the colour of a polygon, by classes or by breaks and ramp"},
    StyleParameter{.id = ParameterId::debug,
                   .name = "debug",
                   .type = Type::words,
                   .words = kDebugMarkNames.names(),
                   .default_text = "nothing",
                   .is_per_layer = false,
                   .description =
                       "debug marks over the tile: each feature in its own colour, the junctions "
                       "of three or more polygons in a coverage, the trapezoids, the tile border "
                       "with its numbers, the remaining vertices"},
    StyleParameter{.id = ParameterId::fill,
                   .name = "fill",
                   .type = Type::colour,
                   .default_text = "the layer's own colour",
                   .description = "colour of the polygons"},
    StyleParameter{.id = ParameterId::fill_opacity,
                   .name = "fill-opacity",
                   .type = Type::number,
                   .max = 1,
                   .default_text = "the layer's own opacity",
                   .description = "opacity of the fill, multiplied by that of its colour"},
    StyleParameter{.id = ParameterId::filter,
                   .name = "filter",
                   .type = Type::filter,
                   .default_text = "all features",
                   .description = "draw only features whose attributes meet this condition"},
    StyleParameter{.id = ParameterId::grow,
                   .name = "grow",
                   .type = Type::number,
                   .max = 16,
                   .default_text = "0",
                   .description = "widen features narrower than this many pixels to that width, as "
                                  "far as neighbours leave room; not together with smooth"},
    StyleParameter{.id = ParameterId::highlight,
                   .name = "highlight",
                   .type = Type::ids,
                   .max_items = kMaxIds,
                   .default_text = "none",
                   .description = "ids of features to draw in the highlight colours"},
    StyleParameter{.id = ParameterId::highlight_fill,
                   .name = "highlight-fill",
                   .type = Type::colour,
                   .default_text = "ffcc00",
                   .description = "fill colour of highlighted features"},
    StyleParameter{.id = ParameterId::highlight_stroke,
                   .name = "highlight-stroke",
                   .type = Type::colour,
                   .default_text = "the stroke",
                   .description = "outline colour of highlighted features"},
    StyleParameter{.id = ParameterId::ids,
                   .name = "ids",
                   .type = Type::ids,
                   .max_items = kMaxIds,
                   .default_text = "all features",
                   .description = "draw only features with these ids"},
    StyleParameter{.id = ParameterId::join,
                   .name = "join",
                   .type = Type::name,
                   .default_text = "the attribute with the name of the key column",
                   .description = "attribute that is joined with the key of the value table"},
    StyleParameter{.id = ParameterId::label,
                   .name = "label",
                   .type = Type::label,
                   .max_items = kMaxTemplateLength,
                   .default_text = "no labels",
                   .description = "label text: the attribute of this name, or text with attributes "
                                  "in braces; value is the joined value; none disables labels"},
    StyleParameter{.id = ParameterId::label_color,
                   .name = "label-color",
                   .type = Type::colour,
                   .default_text = "222222",
                   .description = "text colour of labels"},
    StyleParameter{.id = ParameterId::label_font,
                   .name = "label-font",
                   .type = Type::font,
                   .default_text = "the fonts of legends",
                   .description = "configured fonts for labels"},
    StyleParameter{.id = ParameterId::label_format,
                   .name = "label-format",
                   .type = Type::format,
                   .default_text = "as many digits as needed",
                   .description = "number format of legend and labels"},
    StyleParameter{.id = ParameterId::label_halo_color,
                   .name = "label-halo-color",
                   .type = Type::colour,
                   .default_text = "ffffffcc",
                   .description = "halo colour of labels"},
    StyleParameter{.id = ParameterId::label_halo_width,
                   .name = "label-halo-width",
                   .type = Type::number,
                   .max = 8,
                   .default_text = "1.5",
                   .description = "width of the halo around the letters of labels, in pixels"},
    StyleParameter{.id = ParameterId::label_language,
                   .name = "label-language",
                   .type = Type::language,
                   .default_text = "as the label says",
                   .description = "language of labels, used where the layer has an attribute "
                                  "NAME:LANGUAGE or NAME_LANGUAGE, or the value table has the "
                                  "language, and the fonts have its characters"},
    StyleParameter{.id = ParameterId::label_max_width,
                   .name = "label-max-width",
                   .type = Type::number,
                   .max = 1024,
                   .default_text = "120",
                   .description = "maximum width of a label line, in pixels; longer labels wrap"},
    StyleParameter{.id = ParameterId::label_min_size,
                   .name = "label-min-size",
                   .type = Type::number,
                   .max = 1024,
                   .default_text = "0",
                   .description = "minimum size of labelled polygons, as the side of a square of "
                                  "the same area, in pixels"},
    StyleParameter{.id = ParameterId::label_overhang,
                   .name = "label-overhang",
                   .type = Type::number,
                   .max = 1024,
                   .default_text = "8",
                   .description = "how far a label may extend beyond its polygon, in pixels; "
                                  "labels that do not fit appear at larger scales"},
    StyleParameter{.id = ParameterId::label_parts,
                   .name = "label-parts",
                   .type = Type::word,
                   .words = kLabelPartsWords,
                   .default_text = "largest",
                   .description = "which parts of a feature to label: the largest, or every part "
                                  "in which the label fits"},
    StyleParameter{.id = ParameterId::label_priority,
                   .name = "label-priority",
                   .type = Type::name,
                   .default_text = "area",
                   .description =
                       "numeric attribute that decides which labels take precedence where space is "
                       "short, larger values first; area is the size of the polygon"},
    StyleParameter{
        .id = ParameterId::label_repeat,
        .name = "label-repeat",
        .type = Type::word,
        .words = kYesOrNoWords,
        .default_text = "yes",
        .description =
            "whether to label all features with the same text, or only the first of them"},
    StyleParameter{.id = ParameterId::label_size,
                   .name = "label-size",
                   .type = Type::number,
                   .min = 6,
                   .max = 64,
                   .default_text = "12",
                   .description = "font size of labels, in pixels"},
    StyleParameter{.id = ParameterId::merge,
                   .name = "merge",
                   .type = Type::number,
                   .max = kWidestMerge,
                   .default_text = "in proportion to simplify",
                   .description =
                       "distance up to which polygons are merged into blocks, in pixels, for "
                       "layers configured with merge; simplify changes in proportion"},
    StyleParameter{.id = ParameterId::no_data_color,
                   .name = "no-data-color",
                   .type = Type::colour,
                   .default_text = "the fill",
                   .description = "fill colour of polygons without a value"},
    StyleParameter{.id = ParameterId::opacity,
                   .name = "opacity",
                   .type = Type::number,
                   .max = 1,
                   .default_text = "1",
                   .description = "opacity of the whole layer: fill, pattern and outline"},
    StyleParameter{.id = ParameterId::pattern,
                   .name = "pattern",
                   .type = Type::word,
                   .words = kPatternNames.names(),
                   .default_text = "none",
                   .description = "pattern over the fill, anchored to the map"},
    StyleParameter{.id = ParameterId::pattern_angle,
                   .name = "pattern-angle",
                   .type = Type::number,
                   .min = -360,
                   .max = 360,
                   .default_text = "45, of dots and checker 0",
                   .description = "direction of the pattern, in degrees anticlockwise from east"},
    StyleParameter{.id = ParameterId::pattern_color,
                   .name = "pattern-color",
                   .type = Type::colour,
                   .default_text = "000000",
                   .description = "colour of the pattern"},
    StyleParameter{.id = ParameterId::pattern_size,
                   .name = "pattern-size",
                   .type = Type::number,
                   .min = 2,
                   .max = 64,
                   .default_text = "8",
                   .description = "distance at which the pattern repeats, in pixels"},
    StyleParameter{.id = ParameterId::pattern_width,
                   .name = "pattern-width",
                   .type = Type::number,
                   .min = 0.25,
                   .max = 64,
                   .default_text = "1; stripes: half the size; dots: a third of the size",
                   .description = "width of lines or diameter of dots, in pixels"},
    StyleParameter{.id = ParameterId::quality,
                   .name = "quality",
                   .type = Type::word,
                   .words = kQualityNames.names(),
                   .default_text = "bounded",
                   .is_per_layer = false,
                   .description =
                       "bounded merges indistinguishable colours for smaller tiles, at most 4 of "
                       "255 from the exact picture and 0.5 on average; exact keeps all colours"},
    StyleParameter{.id = ParameterId::ramp,
                   .name = "ramp",
                   .type = Type::ramp,
                   .default_text = "no classes",
                   .description = "colours of the classes between the breaks"},
    StyleParameter{.id = ParameterId::simplify,
                   .name = "simplify",
                   .type = Type::number,
                   .max = kMaxSimplify,
                   .default_text = "0.25",
                   .description =
                       "simplification tolerance: the maximum distance between the drawn and the "
                       "true boundary, in image pixels, rounded to half octaves (by up to 19 %); 0 "
                       "draws every vertex"},
    StyleParameter{
        .id = ParameterId::small,
        .name = "small",
        .type = Type::word,
        .words = kSmallPolygonsNames.names(),
        .default_text = "dust; with grow keep",
        .description =
            "polygons too small for the tolerance: dust preserves their area as a tint, keep draws "
            "each at least one pixel large or as large as grow, drop omits them"},
    StyleParameter{.id = ParameterId::smooth,
                   .name = "smooth",
                   .type = Type::number,
                   .max = 64,
                   .default_text = "0",
                   .description = "how far from a corner rounding begins, in pixels, at most at "
                                  "the middle of each edge; 0 keeps corners sharp"},
    StyleParameter{.id = ParameterId::stroke,
                   .name = "stroke",
                   .type = Type::colour,
                   .default_text = "no outline; black with stroke-width",
                   .description = "colour of the outline"},
    StyleParameter{
        .id = ParameterId::stroke_dasharray,
        .name = "stroke-dasharray",
        .type = Type::numbers,
        .max = 256,
        .max_items = 8,
        .default_text = "no gaps",
        .description = "alternating lengths of dashes and gaps of the outline, in pixels"},
    StyleParameter{.id = ParameterId::stroke_linejoin,
                   .name = "stroke-linejoin",
                   .type = Type::word,
                   .words = kLineJoinNames.names(),
                   .default_text = "round",
                   .description = "corners of the outline"},
    StyleParameter{.id = ParameterId::stroke_opacity,
                   .name = "stroke-opacity",
                   .type = Type::number,
                   .max = 1,
                   .default_text = "1",
                   .description = "opacity of the outline, multiplied by that of its colour"},
    StyleParameter{.id = ParameterId::stroke_width,
                   .name = "stroke-width",
                   .type = Type::number,
                   .max = 32,
                   .default_text = "1 with stroke",
                   .description = "width of the outline, in pixels"},
    StyleParameter{
        .id = ParameterId::style,
        .name = "style",
        .type = Type::style,
        .default_text = "each layer's own style",
        .is_per_layer = false,
        .description = "a named or posted style; other parameters of the query override it"},
    StyleParameter{.id = ParameterId::topology,
                   .name = "topology",
                   .type = Type::word,
                   .words = kTopologyNames.names(),
                   .default_text = "strict",
                   .description = "strict prevents boundaries from crossing each other, fast "
                                  "simplifies without this test"},
    StyleParameter{.id = ParameterId::units,
                   .name = "units",
                   .type = Type::text,
                   .max_items = kMaxTextLength,
                   .default_text = "none",
                   .description = "unit that the legend writes after numbers"},
    StyleParameter{.id = ParameterId::values,
                   .name = "values",
                   .type = Type::table,
                   .default_text = "none",
                   .description = "value table to join, posted to /values or configured; its "
                                  "values are available as value in color-by, filter and label"},
};

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < kParameters.size(); ++i) {
    if (static_cast<std::size_t>(kParameters[i].id) != i) return false;
    if (i > 0 && kParameters[i - 1].name >= kParameters[i].name) return false;
  }
  return true;
}
static_assert(is_in_order(), "the table is indexed by ParameterId and sorted by name");

std::optional<double> parse_number(std::string_view text, double min, double max) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  // Also rejects NaN. Adding 0 turns -0 into 0, so that 0 has one form only.
  if (!(number >= min && number <= max)) return std::nullopt;
  return number + 0.0;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::optional<ParameterValue> parse_numbers(const StyleParameter& parameter,
                                            std::string_view text) {
  std::vector<double> numbers;
  for (const std::string_view part : split(text, ',')) {
    const auto number = parse_number(part, parameter.min, parameter.max);
    if (!number || numbers.size() == parameter.max_items) return std::nullopt;
    if (parameter.type == Type::breaks && !numbers.empty() && *number <= numbers.back()) {
      return std::nullopt;
    }
    numbers.push_back(*number);
  }
  return numbers;
}

/// At least one length must be greater than 0.
std::optional<ParameterValue> parse_dashes(const StyleParameter& parameter, std::string_view text) {
  const auto dashes = parse_numbers(parameter, text);
  if (!dashes) return std::nullopt;
  const auto& lengths = std::get<std::vector<double>>(*dashes);
  const bool has_length = std::ranges::any_of(lengths, [](double length) { return length > 0; });
  return has_length ? dashes : std::nullopt;
}

std::optional<ParameterValue> parse_ids(const StyleParameter& parameter, std::string_view text) {
  std::vector<std::int64_t> ids;
  for (const std::string_view part : split(text, ',')) {
    std::int64_t id = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), id);
    if (error != std::errc() || end != part.data() + part.size()) return std::nullopt;
    if (ids.size() == parameter.max_items) return std::nullopt;
    ids.push_back(id);
  }
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

using KnownWords = std::span<const std::string_view>;

std::optional<ParameterValue> parse_word(std::string_view text, KnownWords known) {
  if (std::ranges::find(known, text) == known.end()) return std::nullopt;
  return std::string(text);
}

/// The canonical form has each word once, in the order of the table. None at all override those of
/// a named style.
std::optional<ParameterValue> parse_words(std::string_view text, KnownWords known) {
  if (text.empty()) return std::string();
  const auto given = split(text, ',');
  for (const std::string_view word : given) {
    if (std::ranges::find(known, word) == known.end()) return std::nullopt;
  }
  std::string canonical;
  for (const std::string_view word : known) {
    if (std::ranges::find(given, word) == given.end()) continue;
    if (!canonical.empty()) canonical.push_back(',');
    canonical += word;
  }
  return canonical;
}

/// Removes a value in single quotes, with quotes inside doubled, from the beginning of `text`.
std::optional<std::string> take_quoted(std::string_view& text) {
  std::string value;
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] != '\'') {
      value += text[i];
    } else if (i + 1 < text.size() && text[i + 1] == '\'') {
      value += text[i++];
    } else {
      text.remove_prefix(i + 1);
      return value;
    }
  }
  return std::nullopt;
}

/// Removes "value:" from the beginning of `text`.
std::optional<ColourClass> take_class_value(std::string_view& text) {
  ColourClass parsed;
  if (text.starts_with('\'')) {
    auto value = take_quoted(text);
    if (!value) return std::nullopt;
    parsed.value = std::move(*value);
  } else {
    const std::size_t end = text.find_first_of(":,");
    if (end == 0 || end == std::string_view::npos) return std::nullopt;
    parsed.value = text.substr(0, end);
    text.remove_prefix(end);
    if (parsed.value == "*") parsed.kind = ColourClass::Kind::others;
    if (parsed.value == "null") parsed.kind = ColourClass::Kind::null;
    if (parsed.kind != ColourClass::Kind::value) parsed.value.clear();
  }
  if (!text.starts_with(':') || has_control_character(parsed.value)) return std::nullopt;
  text.remove_prefix(1);
  return parsed;
}

/// Removes a colour, and the comma after it, from the beginning of `text`. Commas between the
/// parentheses of rgb() belong to the colour.
std::optional<Rgba> take_colour(std::string_view& text) {
  const std::size_t comma = text.find(',');
  const std::size_t bracket = text.find('(');
  std::size_t end = std::min(comma, text.size());
  if (bracket < comma) {
    const std::size_t close = text.find(')', bracket);
    if (close == std::string_view::npos) return std::nullopt;
    end = std::min(text.find(',', close), text.size());
  }
  const auto colour = parse_colour(text.substr(0, end));
  // A trailing comma would need another class after it.
  if (end + 1 == text.size()) return std::nullopt;
  text.remove_prefix(std::min(end + 1, text.size()));
  return colour;
}

std::optional<ParameterValue> parse_classes(const StyleParameter& parameter,
                                            std::string_view text) {
  std::vector<ColourClass> classes;
  while (!text.empty()) {
    auto next = take_class_value(text);
    const auto colour = next ? take_colour(text) : std::nullopt;
    if (!colour || classes.size() == parameter.max_items) return std::nullopt;
    const bool is_double = std::ranges::any_of(classes, [&](const ColourClass& other) {
      return other.kind == next->kind && other.value == next->value;
    });
    if (is_double) return std::nullopt;
    next->colour = *colour;
    classes.push_back(std::move(*next));
  }
  if (classes.empty()) return std::nullopt;
  return classes;
}

std::optional<ParameterValue> parse_name(std::string_view text) {
  if (text.empty() || text.size() > kMaxNameLength) return std::nullopt;
  if (has_control_character(text)) return std::nullopt;
  return std::string(text);
}

std::optional<ParameterValue> parse_breaks(const StyleParameter& parameter, std::string_view text) {
  if (const auto rule = parse_break_rule(text)) return *rule;
  return parse_numbers(parameter, text);
}

std::optional<ParameterValue> parse_text(const StyleParameter& parameter, std::string_view text) {
  if (text.empty() || text.size() > parameter.max_items) return std::nullopt;
  if (has_control_character(text)) return std::nullopt;
  return std::string(text);
}

std::optional<ParameterValue> parse_label(const StyleParameter& parameter, std::string_view text) {
  auto parsed = parse_text(parameter, text);
  return parsed && LabelTemplate::is_valid(text) ? std::move(parsed) : std::nullopt;
}

std::optional<ParameterValue> parse_filter(std::string_view text) {
  auto parsed = Filter::parse(text);
  if (auto* filter = std::get_if<0>(&parsed)) return std::move(*filter);
  return std::nullopt;
}

std::string format_class(const ColourClass& colour_class) {
  const std::string colour = to_hex(colour_class.colour);
  if (colour_class.kind == ColourClass::Kind::others) return "*:" + colour;
  if (colour_class.kind == ColourClass::Kind::null) return "null:" + colour;
  const std::string& value = colour_class.value;
  const bool is_plain = !value.empty() && value != "*" && value != "null" &&
                        value.find_first_of("',:") == std::string::npos;
  return (is_plain ? value : single_quoted(value)) + ":" + colour;
}

/// Calls `format` for each item and joins the results with commas.
template <typename Items, typename Format>
std::string join_formatted(const Items& items, Format format) {
  std::string text;
  for (const auto& item : items) {
    if (!text.empty()) text.push_back(',');
    text += format(item);
  }
  return text;
}

struct Formatter {
  std::string operator()(Rgba colour) const { return to_hex(colour); }
  // The shortest text that is parsed as the same number.
  std::string operator()(double number) const { return fmt::format("{}", number); }
  std::string operator()(const std::string& text) const { return text; }
  std::string operator()(const std::vector<double>& numbers) const {
    return join_formatted(numbers, *this);
  }
  std::string operator()(const std::vector<std::int64_t>& ids) const {
    return join_formatted(ids, [](std::int64_t id) { return fmt::format_int(id).str(); });
  }
  std::string operator()(const std::vector<ColourClass>& classes) const {
    return join_formatted(classes, format_class);
  }
  std::string operator()(const std::shared_ptr<const Filter>& filter) const {
    return filter->text();
  }
  std::string operator()(const BreakRule& rule) const { return break_rule_text(rule); }
  std::string operator()(const NumberFormat& format) const { return number_format_text(format); }
  std::string operator()(const TableChoice& choice) const { return choice.name; }
};

std::string written_name(const StyleSetting& setting) {
  const std::string_view name = style_parameter(setting.parameter).name;
  return setting.layer.empty() ? std::string(name) : fmt::format("{}.{}", setting.layer, name);
}

auto order_of(const StyleSetting& setting) {
  return std::tuple(std::string_view(setting.layer), setting.parameter);
}

struct SettingName {
  std::string_view layer;  // empty for all layers
  const StyleParameter* parameter = nullptr;
};

/// The parameter is null if the name is unknown for these layers.
SettingName resolve_name(std::string_view name, std::span<const std::string> layers) {
  const std::size_t dot = name.find('.');
  if (dot == std::string_view::npos) return {{}, find_style_parameter(name)};
  const std::string_view layer = name.substr(0, dot);
  if (std::ranges::find(layers, layer) == layers.end()) return {};
  const StyleParameter* parameter = find_style_parameter(name.substr(dot + 1));
  if (parameter == nullptr || !parameter->is_per_layer) return {};
  return {layer, parameter};
}

/// The end of the sentence about an unknown name.
std::string reason_or_suggestion(std::string_view name, std::span<const std::string> layers,
                                 const std::vector<std::string>& known) {
  std::string suggestion = suggestion_or_stop(name, known);
  const std::size_t dot = name.find('.');
  const StyleParameter* parameter =
      dot == std::string_view::npos ? nullptr : find_style_parameter(name.substr(dot + 1));
  if (parameter == nullptr) return suggestion;
  const std::string_view layer = name.substr(0, dot);
  if (std::ranges::find(layers, layer) != layers.end()) {
    return fmt::format(": {} applies to the whole tile.", parameter->name);
  }
  return suggestion == "." ? fmt::format(": the request has no layer \"{}\".", layer) : suggestion;
}

Problem unknown_name(const QueryPair& pair, std::span<const std::string> layers,
                     std::span<const std::string_view> others) {
  std::vector<std::string> known(others.begin(), others.end());
  for (const StyleParameter& parameter : kParameters) {
    known.emplace_back(parameter.name);
    if (!parameter.is_per_layer) continue;
    for (const std::string& layer : layers) {
      known.push_back(fmt::format("{}.{}", layer, parameter.name));
    }
  }
  return {400,
          fmt::format("There is no parameter \"{}\"{}", pair.first,
                      reason_or_suggestion(pair.first, layers, known)),
          pair.first, pair.second,
          fmt::format("one of {}; {} may be anything", fmt::join(known, ", "), kFreeParameter)};
}

Problem given_twice(const QueryPair& pair, const std::string& takes) {
  return {400, fmt::format("The parameter {} is given more than once.", pair.first), pair.first,
          pair.second, takes + ", once"};
}

Problem wrong_value(const StyleParameter& parameter, const QueryPair& pair) {
  const std::string takes = describe_values(parameter);
  std::string detail = fmt::format("The parameter {} takes {}.", pair.first, takes);
  if (parameter.type == Type::filter) {
    if (const auto parsed = Filter::parse(pair.second); parsed.index() == 1) {
      detail += fmt::format(" In this one, {}.", std::get<Filter::Mistake>(parsed).what);
    }
  }
  return {400, std::move(detail), pair.first, pair.second, takes};
}

}  // namespace

bool is_classing_parameter(ParameterId id) {
  return std::ranges::find(kClassingParameters, id) != kClassingParameters.end();
}

std::span<const StyleParameter> style_parameters() {
  return kParameters;
}

const StyleParameter& style_parameter(ParameterId id) {
  return kParameters[static_cast<std::size_t>(id)];
}

const StyleParameter* find_style_parameter(std::string_view name) {
  const auto known = style_parameters();
  const auto found = std::ranges::lower_bound(known, name, {}, &StyleParameter::name);
  return found == known.end() || found->name != name ? nullptr : &*found;
}

std::optional<ParameterValue> parse_parameter(const StyleParameter& parameter,
                                              std::string_view text) {
  switch (parameter.type) {
    case Type::colour:
      return parse_colour(text);
    case Type::number:
      return parse_number(text, parameter.min, parameter.max);
    case Type::numbers:
      return parse_dashes(parameter, text);
    case Type::breaks:
      return parse_breaks(parameter, text);
    case Type::word:
      return parse_word(text, parameter.words);
    case Type::words:
      return parse_words(text, parameter.words);
    case Type::name:
      return parse_name(text);
    case Type::ramp:
      return find_ramp(text);
    case Type::ids:
      return parse_ids(parameter, text);
    case Type::classes:
      return parse_classes(parameter, text);
    case Type::filter:
      return parse_filter(text);
    case Type::style:
      if (is_url_name(text)) return std::string(text);
      break;
    case Type::format:
      return parse_number_format(text);
    case Type::text:
      return parse_text(parameter, text);
    case Type::table:
      if (is_url_name(text)) return TableChoice{std::string(text)};
      break;
    case Type::label:
      return parse_label(parameter, text);
    case Type::font:
      if (is_url_name(text)) return std::string(text);
      break;
    case Type::language:
      if (is_language_tag(text)) return std::string(text);
      break;
  }
  return std::nullopt;
}

std::string format_value(const ParameterValue& value) {
  return std::visit(Formatter{}, value);
}

std::string describe_values(const StyleParameter& parameter) {
  switch (parameter.type) {
    case Type::colour:
      return "a colour: hex digits without # (rgb, rgba, rrggbb or rrggbbaa), a CSS name, "
             "rgb(r,g,b) or rgba(r,g,b,a)";
    case Type::number:
      return fmt::format("a number from {} to {}", parameter.min, parameter.max);
    case Type::numbers:
      return fmt::format("1 to {} numbers from {} to {}, not all 0, separated by commas",
                         parameter.max_items, parameter.min, parameter.max);
    case Type::breaks:
      return fmt::format(
          "1 to {} numbers, each greater than the one before, separated by commas; or one of {} "
          "with "
          "a number of classes from 2 to {}, such as quantile:5; or stddev",
          parameter.max_items, "equal, jenks, pretty, quantile", kMostRuledClasses);
    case Type::word:
      return fmt::format("one of {}", fmt::join(parameter.words, ", "));
    case Type::words:
      return fmt::format("some of {}, separated by commas", fmt::join(parameter.words, ", "));
    case Type::name:
      return "the name of an attribute of the layer";
    case Type::ramp:
      return fmt::format("the name of a ColorBrewer ramp, with -r appended to reverse it: {}",
                         ramp_names());
    case Type::ids:
      return fmt::format("1 to {} integers, separated by commas", parameter.max_items);
    case Type::classes:
      return fmt::format(
          "1 to {} pairs value:colour, separated by commas, each value once; a value with a comma, "
          "colon or quote goes in single quotes",
          parameter.max_items);
    case Type::filter:
      return fmt::format(
          "a condition in CQL2 text of at most {} bytes: =, <>, <, <=, >, >=, IN, BETWEEN, LIKE, "
          "IS NULL, AND, OR, NOT, parentheses; text in single quotes",
          kMaxFilterLength);
    case Type::style:
      return "the name of a style, of 1 to 64 letters, digits, '_' or '-'";
    case Type::format:
      return "a d3 format such as ,.1f (grouped thousands, one decimal), .0% (percent) or .3s "
             "(three significant digits, with k, M, G)";
    case Type::text:
      return fmt::format("1 to {} bytes of text", parameter.max_items);
    case Type::table:
      return "an id returned by POST /values, or the name of a configured table";
    case Type::label:
      return fmt::format(
          "the name of an attribute, or text with attribute names in braces, of at most {} bytes",
          parameter.max_items);
    case Type::font:
      return "the name of configured fonts";
    case Type::language:
      return "a language tag, such as de or zh-Hans";
  }
  return {};
}

Result<StyleQuery> StyleQuery::parse(std::span<const QueryPair> pairs,
                                     std::span<const std::string> layers,
                                     std::span<const std::string_view> others) {
  StyleQuery query;
  std::set<std::string_view> others_given;
  for (const QueryPair& pair : pairs) {
    if (pair.first == kFreeParameter) continue;
    if (std::ranges::find(others, pair.first) != others.end()) {
      if (!others_given.insert(pair.first).second) return given_twice(pair, "one value");
      continue;
    }
    const auto [layer, parameter] = resolve_name(pair.first, layers);
    if (parameter == nullptr) return unknown_name(pair, layers, others);
    if (parameter->id == ParameterId::style) continue;
    if (query.find_setting(layer, parameter->id) != nullptr)
      return given_twice(pair, describe_values(*parameter));
    auto value = parse_parameter(*parameter, pair.second);
    if (!value) return wrong_value(*parameter, pair);
    query.settings_.push_back({std::string(layer), parameter->id, std::move(*value)});
  }
  std::ranges::sort(query.settings_, {}, order_of);
  return query;
}

const ParameterValue* StyleQuery::find(std::string_view layer, ParameterId parameter) const {
  const StyleSetting* setting = find_setting(layer, parameter);
  if (setting == nullptr && !is_excluded(layer, parameter)) setting = find_setting({}, parameter);
  return setting == nullptr ? nullptr : &setting->value;
}

bool StyleQuery::is_excluded(std::string_view layer, ParameterId parameter) const {
  if (parameter == ParameterId::classes) {
    return find_setting(layer, ParameterId::breaks) != nullptr ||
           find_setting(layer, ParameterId::ramp) != nullptr;
  }
  const bool is_of_breaks = parameter == ParameterId::breaks || parameter == ParameterId::ramp;
  return is_of_breaks && find_setting(layer, ParameterId::classes) != nullptr;
}

std::optional<ParameterValue> StyleQuery::value_for(std::string_view layer,
                                                    ParameterId parameter) const {
  const ParameterValue* value = find(layer, parameter);
  return value == nullptr ? std::nullopt : std::optional(*value);
}

StyleQuery StyleQuery::with_defaults(const std::string& layer, const StyleQuery& defaults) const {
  StyleQuery style = *this;
  const bool has_classing = std::ranges::any_of(
      kClassingParameters, [&](ParameterId id) { return find(layer, id) != nullptr; });
  for (const StyleSetting& setting : defaults.settings_) {
    if (find(layer, setting.parameter) != nullptr) continue;
    if (has_classing && is_classing_parameter(setting.parameter)) continue;
    style.settings_.push_back({layer, setting.parameter, setting.value});
  }
  std::ranges::sort(style.settings_, {}, order_of);
  return style;
}

StyleQuery StyleQuery::over(const StyleQuery& style, std::span<const std::string> layers) const {
  StyleQuery both = *this;
  for (const StyleSetting& setting : style.settings_) {
    const bool is_asked_for =
        setting.layer.empty() || std::ranges::find(layers, setting.layer) != layers.end();
    if (is_asked_for && !sets(setting)) both.settings_.push_back(setting);
  }
  std::ranges::sort(both.settings_, {}, order_of);
  return both;
}

StyleQuery StyleQuery::of_layer(const std::string& layer) const {
  StyleQuery style;
  for (const StyleSetting& setting : settings_) {
    if (!setting.layer.empty() && setting.layer != layer) continue;
    if (find(layer, setting.parameter) != &setting.value) continue;  // its own comes first
    style.settings_.push_back(setting);
    if (style_parameter(setting.parameter).is_per_layer) style.settings_.back().layer = layer;
  }
  std::ranges::sort(style.settings_, {}, order_of);
  return style;
}

StyleQuery StyleQuery::without_those_of(const StyleQuery& query) const {
  StyleQuery style = *this;
  std::erase_if(style.settings_, [&query](const StyleSetting& setting) {
    StyleSetting for_all = setting;
    for_all.layer.clear();
    return query.sets(setting) || query.sets(for_all);
  });
  return style;
}

StyleQuery StyleQuery::with_tables(const FindTable& find) && {
  for (StyleSetting& setting : settings_) {
    auto* choice = std::get_if<TableChoice>(&setting.value);
    if (choice != nullptr && choice->table == nullptr) choice->table = find(choice->name);
  }
  return std::move(*this);
}

StyleQuery StyleQuery::configured() && {
  for (StyleSetting& setting : settings_) setting.is_configured = true;
  return std::move(*this);
}

bool StyleQuery::sets(const StyleSetting& setting) const {
  return std::ranges::any_of(settings_, [&setting](const StyleSetting& own) {
    return own.layer == setting.layer &&
           (own.parameter == setting.parameter ||
            (is_classing_parameter(own.parameter) && is_classing_parameter(setting.parameter)));
  });
}

std::vector<QueryPair> StyleQuery::pairs() const {
  std::vector<QueryPair> pairs;
  for (const StyleSetting& setting : settings_) {
    pairs.emplace_back(written_name(setting), format_value(setting.value));
  }
  return pairs;
}

std::string StyleQuery::canonical_text() const {
  std::string text;
  for (const auto& [name, value] : pairs()) {
    if (!text.empty()) text.push_back('&');
    text += name + '=' + percent_encode(value);
  }
  return text;
}

const StyleSetting* StyleQuery::find_setting(std::string_view layer, ParameterId parameter) const {
  const auto found = std::ranges::find_if(settings_, [&](const StyleSetting& setting) {
    return setting.layer == layer && setting.parameter == parameter;
  });
  return found == settings_.end() ? nullptr : &*found;
}

}  // namespace trapeze
