#include "server/tiles/layer_style.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/mesh/exaggeration.h"
#include "server/base/nearest_name.h"
#include "server/base/problem.h"
#include "server/styles/colour_ramps.h"
#include "server/values/attributes.h"

namespace trapeze {
namespace {

// Colours of layers that have none configured: muted, distinct, readable on top of each other.
constexpr std::array<Rgba, 8> kPalette = {{{0x7f, 0xa6, 0x87, 255},
                                           {0x6f, 0xa8, 0xc9, 255},
                                           {0xd9, 0x9b, 0x6c, 255},
                                           {0x9d, 0x87, 0xb8, 255},
                                           {0xd7, 0xb9, 0x5b, 255},
                                           {0xc6, 0x7b, 0x82, 255},
                                           {0x62, 0xa6, 0xa0, 255},
                                           {0x94, 0x8b, 0x80, 255}}};
/// The colour of the layer at `position`, once the palette is used up: hues spaced by the golden
/// angle, which stay distinct for any number of layers.
Rgba hue_at(std::size_t position) {
  constexpr double kGoldenAngle = 137.50776405003785;
  constexpr double kMiddle = 158;  // of the channels, and the deviation from it
  constexpr double kReach = 46;
  const double degrees = std::fmod(static_cast<double>(position) * kGoldenAngle, 360);
  const auto channel = [&](double turned) {
    const double radians = (degrees - turned) * M_PI / 180;
    return static_cast<std::uint8_t>(std::lround(kMiddle + kReach * std::cos(radians)));
  };
  return {channel(0), channel(120), channel(240), 255};
}

constexpr Rgba kHighlight{0xff, 0xcc, 0x00, 255};
constexpr Rgba kBlack{0, 0, 0, 255};

/// The settings of a query that apply to one layer.
class LayerSettings {
 public:
  LayerSettings(const StyleQuery& query, const std::string& layer) : query_(query), layer_(layer) {}

  template <typename T>
  const T* find(ParameterId id) const {
    const ParameterValue* value = query_.find(layer_, id);
    return value == nullptr ? nullptr : &std::get<T>(*value);
  }
  /// Null if it is not set.
  const ParameterValue* find_value(ParameterId id) const { return query_.find(layer_, id); }
  bool has(ParameterId id) const { return find_value(id) != nullptr; }

  template <typename T>
  T value_or(ParameterId id, T otherwise) const {
    const T* value = find<T>(id);
    return value == nullptr ? otherwise : *value;
  }

  std::string text_of(ParameterId id) const { return format_value(*query_.find(layer_, id)); }

 private:
  const StyleQuery& query_;
  const std::string& layer_;
};

std::optional<Problem> find_locked(const StyleQuery& query, const LayerConfig& config) {
  for (const StyleSetting& setting : query.settings()) {
    if (setting.is_configured) continue;
    if (!setting.layer.empty() && setting.layer != config.name) continue;
    if (std::ranges::find(config.locked, setting.parameter) == config.locked.end()) continue;
    const std::string name(style_parameter(setting.parameter).name);
    return Problem{400,
                   fmt::format("The parameter {} of the layer {} is locked by its operator.", name,
                               config.name),
                   name, format_value(setting.value), "nothing: leave it out for this layer"};
  }
  return std::nullopt;
}

Rgba fill_of(const LayerSettings& settings, const LayerConfig& config, std::size_t position) {
  return settings.value_or(ParameterId::fill, default_fill(config, position));
}

Stroke stroke_of(const LayerSettings& settings) {
  Stroke stroke;
  const bool is_wanted =
      settings.has(ParameterId::stroke) || settings.has(ParameterId::stroke_width);
  stroke.width = settings.value_or(ParameterId::stroke_width, is_wanted ? 1.0 : 0.0);
  stroke.dashes = settings.value_or(ParameterId::stroke_dasharray, std::vector<double>());
  if (stroke.dashes.size() % 2 == 1) {  // as in SVG, the list is repeated
    const std::vector<double> once = stroke.dashes;
    stroke.dashes.insert(stroke.dashes.end(), once.begin(), once.end());
  }
  const auto* join = settings.find<std::string>(ParameterId::stroke_linejoin);
  if (join != nullptr) stroke.join = kLineJoinNames.find(*join).value();
  return stroke;
}

double default_width(PatternKind kind, double size) {
  if (kind == PatternKind::stripes) return size / 2;
  return kind == PatternKind::dots ? size / 3 : 1;
}

Pattern pattern_of(const LayerSettings& settings) {
  Pattern pattern;
  const auto* kind = settings.find<std::string>(ParameterId::pattern);
  if (kind != nullptr) pattern.kind = kPatternNames.find(*kind).value();
  if (pattern.kind == PatternKind::none) return pattern;
  pattern.colour = settings.value_or(ParameterId::pattern_color, kBlack);
  pattern.size = settings.value_or(ParameterId::pattern_size, 8.0);
  const bool is_upright = pattern.kind == PatternKind::dots || pattern.kind == PatternKind::checker;
  const double angle = settings.value_or(ParameterId::pattern_angle, is_upright ? 0.0 : 45.0);
  pattern.angle = std::fmod(angle + 360, 360);
  pattern.width =
      settings.value_or(ParameterId::pattern_width, default_width(pattern.kind, pattern.size));
  return pattern;
}

// ---- classes

Problem contradiction(std::string_view detail, ParameterId id, const LayerSettings& settings,
                      std::string_view takes) {
  return {400, std::string(detail), std::string(style_parameter(id).name), settings.text_of(id),
          std::string(takes)};
}

/// Checks which of the four settings are combined.
std::optional<Problem> find_contradiction(const LayerSettings& settings) {
  const bool has_classes = settings.has(ParameterId::classes);
  const bool has_breaks = settings.has(ParameterId::breaks);
  const bool has_ramp = settings.has(ParameterId::ramp);
  if (has_classes && (has_breaks || has_ramp)) {
    return contradiction("Use either classes, or breaks with a ramp.", ParameterId::classes,
                         settings, "no breaks or ramp");
  }
  if (has_breaks != has_ramp) {
    return contradiction(
        "breaks and ramp need each other: breaks divide the numbers, the ramp colours them.",
        has_breaks ? ParameterId::breaks : ParameterId::ramp, settings,
        has_breaks ? "ramp beside it" : "breaks beside it");
  }
  const bool has_rules = has_classes || has_breaks;
  if (has_rules && !settings.has(ParameterId::color_by)) {
    return contradiction("classes need an attribute: color-by.",
                         has_classes ? ParameterId::classes : ParameterId::breaks, settings,
                         "color-by beside it");
  }
  if (!has_rules && settings.has(ParameterId::color_by)) {
    return contradiction("color-by needs classes, or breaks with a ramp.", ParameterId::color_by,
                         settings, "classes, or breaks and ramp");
  }
  return std::nullopt;
}

template <typename Number>
std::optional<FilterLiteral> read_number(const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (std::isnan(static_cast<double>(number))) return std::nullopt;  // equals nothing
  return FilterLiteral(number);
}

/// The value converted to the type of the field; nothing if it cannot be converted.
std::optional<FilterLiteral> read_as(FieldType type, const std::string& text) {
  switch (type) {
    case FieldType::integer:
      return read_number<std::int64_t>(text);
    case FieldType::real:
      return read_number<double>(text);
    case FieldType::text:
      return FilterLiteral(text);
  }
  return std::nullopt;
}

/// The parts of a layer's style, step by step.
struct Making {
  LayerSettings settings;
  const ServedLayer& served;
  const FeatureTable& features;
  Looking looking = Looking::for_drawing;
  double fill_opacity = 1;
  Rgba others = kTransparent;  // with the opacity applied
  LayerStyle style = {};
  std::vector<Rgba> fills = {};  // of the classes by value

  std::shared_ptr<DerivedValues> own_derived = {};  // if the layer keeps none

  Attributes attributes() const { return {features, style.classing.joined}; }
  DerivedValues& derived() {
    if (served.derived != nullptr) return *served.derived;
    if (own_derived == nullptr) own_derived = std::make_shared<DerivedValues>();
    return *own_derived;
  }
};

/// The problem for a setting that needs all features at the same time, which layers in many parts
/// do not offer.
Problem not_in_parts(const std::string& parameter, const std::string& allowed,
                     const ServedLayer& served) {
  return {
      400,
      fmt::format("The layer {} is in several parts, and \"{}\" would have to read all of them.",
                  served.config.name, parameter),
      parameter, "", allowed};
}

// ---- joined values

Problem unknown_table(const std::string& name, const ServedLayer& served) {
  std::vector<std::string> known;
  if (served.tables != nullptr) {
    for (const auto& [each, table] : *served.tables) known.push_back(each);
  }
  const std::string of_config =
      known.empty() ? "" : fmt::format("one of {}, or ", fmt::join(known, ", "));
  return {404,
          fmt::format("There is no table of that name{} Posted tables expire when memory is "
                      "needed: post it again.",
                      suggestion_or_stop(name, known)),
          "values", name, of_config + "an id returned by POST /values"};
}

/// Null if there is none of that name.
std::shared_ptr<const ValueTable> find_table(const TableChoice& choice, const ServedLayer& served) {
  if (served.tables != nullptr) {
    const auto named = served.tables->find(choice.name);
    if (named != served.tables->end()) return named->second.table;
  }
  return choice.table;
}

/// The translation of the table into the language of the labels; null if there is none.
std::shared_ptr<const ValueTable> find_translation(const LayerSettings& settings,
                                                   const ServedLayer& served) {
  const auto* choice = settings.find<TableChoice>(ParameterId::values);
  const auto* language = settings.find<std::string>(ParameterId::label_language);
  if (choice == nullptr || language == nullptr || served.tables == nullptr) return nullptr;
  const auto named = served.tables->find(choice->name);
  if (named == served.tables->end()) return nullptr;
  const auto found = named->second.languages.find(*language);
  return found == named->second.languages.end() ? nullptr : found->second;
}

/// The index of the key attribute, or -1.
int field_to_join(const LayerSettings& settings, const ValueTable& table,
                  const FeatureTable& features) {
  const auto* name = settings.find<std::string>(ParameterId::join);
  return features.field_index(name == nullptr ? table.names().key : *name);
}

std::optional<Problem> make_joined(Making& making) {
  const auto* choice = making.settings.find<TableChoice>(ParameterId::values);
  const auto* attribute = making.settings.find<std::string>(ParameterId::join);
  if (choice == nullptr) {
    if (attribute == nullptr) return std::nullopt;
    return Problem{400, "join needs a table: values.", "join", *attribute, "values beside it"};
  }
  const auto table = find_table(*choice, making.served);
  if (table == nullptr) return unknown_table(choice->name, making.served);
  const int field = field_to_join(making.settings, *table, making.features);
  if (field < 0) {
    Problem problem = unknown_property(
        "join", attribute == nullptr ? table->names().key : *attribute, making.features);
    if (attribute == nullptr) {
      problem.detail +=
          " This is the key column of the table: set join to the attribute with the keys.";
    }
    return problem;
  }
  if (making.served.parts != nullptr) return not_in_parts("values", "no table", making.served);
  auto joined = making.derived().join(making.served.revision, *making.served.layer, field, table);
  if (!joined) return std::move(joined).problem();
  making.style.classing.joined = *std::move(joined);
  making.style.join_attribute = making.features.fields()[static_cast<std::size_t>(field)].name;
  return std::nullopt;
}

// ---- classes by value

/// Values with the same colour share a pass, so that there are only as many passes as colours.
void make_alike(Making& making) {
  std::vector<std::uint8_t> alike;
  for (const Rgba fill : making.fills) {
    const auto first = std::ranges::find(making.fills, fill);
    alike.push_back(static_cast<std::uint8_t>(first - making.fills.begin()));
  }
  making.style.classing.alike = std::move(alike);
}

/// The colour of features without a value, if it is set separately.
std::optional<Rgba> no_data_colour(const Making& making) {
  const auto* colour = making.settings.find<Rgba>(ParameterId::no_data_color);
  if (colour == nullptr) return std::nullopt;
  return with_opacity(*colour, making.fill_opacity);
}

std::optional<Problem> make_values(Making& making, const Field& field) {
  for (const ColourClass& wanted :
       *making.settings.find<std::vector<ColourClass>>(ParameterId::classes)) {
    const Rgba colour = with_opacity(wanted.colour, making.fill_opacity);
    if (wanted.kind == ColourClass::Kind::others) {
      making.others = colour;
      continue;
    }
    std::optional<FilterLiteral> value;
    if (wanted.kind == ColourClass::Kind::value) {
      value = read_as(field.type, wanted.value);
      if (!value) {
        const bool is_integer = field.type == FieldType::integer;
        return Problem{400,
                       fmt::format("The attribute {} holds {}, and \"{}\" is not {}.", field.name,
                                   is_integer ? "integers" : "numbers", wanted.value,
                                   is_integer ? "an integer" : "a number"),
                       "classes", wanted.value,
                       is_integer ? "integers as values" : "numbers as values"};
      }
      if (std::ranges::find(making.style.classing.values, value) !=
          making.style.classing.values.end()) {
        return Problem{400,
                       fmt::format("The classes have the number {} of {} more than once.",
                                   wanted.value, field.name),
                       "classes", wanted.value, "each value once"};
      }
    }
    making.style.classing.values.push_back(std::move(value));
    making.fills.push_back(colour);
  }
  const auto& values = making.style.classing.values;
  const bool has_null =
      std::ranges::any_of(values, [](const auto& value) { return !value.has_value(); });
  if (const auto colour = no_data_colour(making); colour && !has_null) {
    constexpr std::size_t kMostBeside = 252;  // classes are numbered by a byte
    if (values.size() > kMostBeside) {
      return Problem{
          400, fmt::format("There can be at most {} classes besides no-data-color.", kMostBeside),
          "no-data-color", to_hex(*colour), "null: among the classes"};
    }
    making.style.classing.values.emplace_back(std::nullopt);
    making.fills.push_back(*colour);
  }
  make_alike(making);
  return std::nullopt;
}

/// For the attribute of that index, which is numeric.
std::shared_ptr<const ValueSpread> spread_of_field(Making& making, int field) {
  if (field == making.attributes().joined_index()) {
    return making.derived().spread(making.served.revision, *making.style.classing.joined);
  }
  return making.derived().spread(making.served.revision, *making.served.layer, field);
}

std::vector<double> ruled_breaks(Making& making, const BreakRule& rule) {
  const Classing& classing = making.style.classing;
  if (classing.field == making.attributes().joined_index()) {
    return making.derived().breaks(making.served.revision, *classing.joined, rule);
  }
  return making.derived().breaks(making.served.revision, *making.served.layer, classing.field,
                                 rule);
}

/// If all numbers are equal, they form one class; if there are none, no feature has a value.
void make_undivided(Making& making, const std::string& ramp) {
  Classing& classing = making.style.classing;
  const auto spread = spread_of_field(making, classing.field);
  if (spread->is_empty()) {
    classing.field = -1;
    return;
  }
  classing.breaks = {spread->least()};  // there are no smaller numbers
  const auto colours = ramp_colours(ramp, 1);
  making.fills.assign(2, with_opacity(colours ? colours->front() : kBlack, making.fill_opacity));
}

std::optional<Problem> make_breaks(Making& making, const Field& field) {
  const LayerSettings& settings = making.settings;
  if (field.type == FieldType::text) {
    const JoinedValues* joined = making.style.classing.joined.get();
    const bool is_joined =
        joined != nullptr && making.style.classing.field == making.attributes().joined_index();
    return Problem{
        400,
        is_joined
            ? fmt::format(
                  "The values of the table are text, such as \"{}\", which breaks cannot divide.",
                  echoed(joined->table().first_word()))
            : fmt::format("The attribute {} holds text, which breaks cannot divide.", field.name),
        "color-by", field.name, "a numeric attribute, or classes instead of breaks"};
  }
  // Everything that is not a number has no value.
  making.others = no_data_colour(making).value_or(making.others);
  const auto& ramp = *settings.find<std::string>(ParameterId::ramp);
  const ParameterValue& setting = *settings.find_value(ParameterId::breaks);
  const auto* rule = std::get_if<BreakRule>(&setting);
  if (rule != nullptr && making.served.parts != nullptr) {
    return not_in_parts("breaks", "numbers", making.served);
  }
  making.style.origin->rule = rule == nullptr ? std::nullopt : std::optional(*rule);
  const std::vector<double> breaks =
      rule == nullptr ? std::get<std::vector<double>>(setting) : ruled_breaks(making, *rule);
  if (breaks.empty()) {
    make_undivided(making, ramp);
    return std::nullopt;
  }
  const auto colours = ramp_colours(ramp, breaks.size() + 1);
  if (!colours) {
    return Problem{400,
                   fmt::format("The ramp {} has fewer colours than the {} classes need.", ramp,
                               breaks.size() + 1),
                   "ramp", ramp, "a ramp with more colours, or fewer breaks"};
  }
  making.style.classing.breaks = breaks;
  for (const Rgba colour : *colours) {
    making.fills.push_back(with_opacity(colour, making.fill_opacity));
  }
  return std::nullopt;
}

std::optional<Problem> make_classes(Making& making) {
  if (auto problem = find_contradiction(making.settings)) return problem;
  const auto* property = making.settings.find<std::string>(ParameterId::color_by);
  if (property == nullptr) return std::nullopt;
  const Attributes attributes = making.attributes();
  const int number = attributes.field_index(*property);
  if (number < 0) return unknown_property("color-by", *property, attributes);
  making.style.classing.field = number;
  making.style.origin = ClassOrigin{*property, std::nullopt};
  const Field& field = attributes.field(number);
  auto problem = making.settings.has(ParameterId::classes) ? make_values(making, field)
                                                           : make_breaks(making, field);
  if (problem) return problem;
  const bool is_wanted = making.style.origin->rule || making.looking == Looking::for_legend;
  // For a layer in parts, only the breaks themselves are known here.
  if (is_wanted && field.type != FieldType::text && making.served.parts == nullptr) {
    making.style.origin->spread = spread_of_field(making, number);
  }
  return std::nullopt;
}

/// There is nothing to add: tolerance_in_pixels() takes the distance into account.
std::optional<Problem> check_merge(const Making& making) {
  const auto* merge = making.settings.find<double>(ParameterId::merge);
  if (merge == nullptr || *merge == 0) return std::nullopt;
  const std::string& name = making.served.config.name;
  const double built = making.served.merge();
  if (built == 0) {
    return Problem{400,
                   fmt::format("The layer {} is not merged into blocks: this needs merge = 4, or "
                               "another distance, in its configuration, or --merge 4.",
                               name),
                   "merge", fmt::format("{}", *merge), "a layer that is merged into blocks"};
  }
  const double widest = style_parameter(ParameterId::simplify).max / kTolerancePixels * built;
  if (*merge <= widest) return std::nullopt;
  return Problem{
      400,
      fmt::format("The layer {} merges polygons up to {} pixels apart, which is not enough for {}.",
                  name, built, *merge),
      "merge", fmt::format("{}", *merge), fmt::format("at most {}", widest)};
}

std::optional<Problem> make_selection(Making& making) {
  Classing& classing = making.style.classing;
  using Ids = std::vector<std::int64_t>;
  classing.ids = making.settings.value_or(ParameterId::ids, Ids());
  classing.highlighted_ids = making.settings.value_or(ParameterId::highlight, Ids());
  const auto* filter = making.settings.find<std::shared_ptr<const Filter>>(ParameterId::filter);
  if (filter == nullptr) return std::nullopt;
  auto bound = BoundFilter::bind(*filter, making.attributes());
  if (!bound) return std::move(bound).problem();
  classing.filter = std::make_shared<const BoundFilter>(*std::move(bound));
  return std::nullopt;
}

// ---- labels

constexpr std::string_view kNoLabel = "none";  // an attribute of that name needs braces

/// The index of the attribute by which labels are ordered; -1 for the area.
Result<int> label_priority(const Making& making) {
  const auto* name = making.settings.find<std::string>(ParameterId::label_priority);
  if (name == nullptr || *name == "area") return -1;
  const Attributes attributes = making.attributes();
  const int number = attributes.field_index(*name);
  if (number < 0) return unknown_property("label-priority", *name, attributes);
  if (attributes.field(number).type == FieldType::text) {
    return Problem{400,
                   fmt::format("The attribute {} holds text and cannot be ordered by size.", *name),
                   "label-priority", *name, "a numeric attribute, or area"};
  }
  return number;
}

/// The values already joined, in the language of the labels; null if there are none.
Result<std::shared_ptr<const JoinedValues>> translated_values(Making& making) {
  const ServedLayer& served = making.served;
  const auto table = find_translation(making.settings, served);
  if (making.style.classing.joined == nullptr || table == nullptr) {
    return std::shared_ptr<const JoinedValues>();
  }
  const int field = making.features.field_index(making.style.join_attribute);
  return making.derived().join(served.revision, *served.layer, field, table);
}

std::optional<Problem> make_label(Making& making) {
  const LayerSettings& settings = making.settings;
  const auto* written = settings.find<std::string>(ParameterId::label);
  if (written == nullptr || *written == kNoLabel) return std::nullopt;
  if (making.served.parts != nullptr) return not_in_parts("label", "no labels", making.served);
  const std::string language = settings.value_or(ParameterId::label_language, std::string());
  auto text = LabelTemplate::bind(*written, making.attributes(), language);
  if (!text) return std::move(text).problem();
  auto priority = label_priority(making);
  if (!priority) return std::move(priority).problem();
  LabelStyle style;
  style.written = *written;
  style.text = *std::move(text);
  style.format = making.style.label_format;
  style.joined = making.style.classing.joined;
  if (!language.empty()) {
    auto translated = translated_values(making);
    if (!translated) return std::move(translated).problem();
    style.language = language;
    style.translated = *std::move(translated);
  }
  style.font = settings.value_or(ParameterId::label_font, std::string());
  style.size = settings.value_or(ParameterId::label_size, style.size);
  style.colour = settings.value_or(ParameterId::label_color, style.colour);
  style.halo_colour = settings.value_or(ParameterId::label_halo_color, style.halo_colour);
  style.halo_width = settings.value_or(ParameterId::label_halo_width, style.halo_width);
  style.max_width = settings.value_or(ParameterId::label_max_width, style.max_width);
  style.min_size = settings.value_or(ParameterId::label_min_size, style.min_size);
  style.overhang = settings.value_or(ParameterId::label_overhang, style.overhang);
  style.priority = *priority;
  style.repeats = settings.value_or(ParameterId::label_repeat, std::string("yes")) == "yes";
  style.all_parts = settings.value_or(ParameterId::label_parts, std::string("largest")) == "all";
  making.style.label = std::make_shared<const LabelStyle>(std::move(style));
  return std::nullopt;
}

std::optional<Problem> make_boundary(Making& making) {
  LayerStyle& style = making.style;
  style.grow = making.settings.value_or(ParameterId::grow, 0.0);
  style.smooth = making.settings.value_or(ParameterId::smooth, 0.0);
  if (style.grow == 0 || style.smooth == 0) return std::nullopt;
  return Problem{400, "grow and smooth exclude each other.", "grow", fmt::format("{}", style.grow),
                 "0 with smooth, or smooth=0"};
}

void make_paints(Making& making) {
  const LayerSettings& settings = making.settings;
  const double opacity = settings.value_or(ParameterId::stroke_opacity, 1.0);
  const Rgba stroke = settings.value_or(ParameterId::stroke, kBlack);
  const Rgba drawn_stroke = with_opacity(stroke, opacity);
  std::vector<ClassPaint>& paints = making.style.paints;
  for (const Rgba fill : making.fills) paints.push_back({fill, drawn_stroke});
  paints.push_back({making.others, drawn_stroke});
  if (making.style.classing.highlighted_ids.empty()) return;
  paints.push_back({settings.value_or(ParameterId::highlight_fill, kHighlight),
                    settings.value_or(ParameterId::highlight_stroke, drawn_stroke)});
}

}  // namespace

double LayerStyle::reach(double scale) const {
  const double of_growth = grow > 0 ? Exaggeration::reach_of(grow * scale) : 0;
  return (stroke.width > 0 ? stroke.reach(scale) : 0) + 2 * smooth * scale + of_growth;
}

bool LayerStyle::is_visible() const {
  if (opacity == 0) return false;
  if (pattern.kind != PatternKind::none && pattern.colour.a > 0) return true;
  return std::ranges::any_of(paints, [this](const ClassPaint& paint) {
    return paint.fill.a > 0 || (stroke.width > 0 && paint.stroke.a > 0);
  });
}

std::string LayerStyle::key() const {
  std::string text = classing.is_plain() ? std::string() : classing.key() + " ";
  for (const ClassPaint& paint : paints) {
    text += to_hex(paint.fill);
    if (stroke.width > 0) text += "/" + to_hex(paint.stroke);
    text += ' ';
  }
  if (stroke.width > 0) {
    text += fmt::format("stroke {} {} {} ", stroke.width, fmt::join(stroke.dashes, ","),
                        static_cast<int>(stroke.join));
  }
  if (pattern.kind != PatternKind::none) {
    text += fmt::format("pattern {} {} {} {} {} ", static_cast<int>(pattern.kind),
                        to_hex(pattern.colour), pattern.size, pattern.angle, pattern.width);
  }
  if (grow > 0) text += fmt::format("grow {} ", grow);
  if (smooth > 0) text += fmt::format("smooth {} ", smooth);
  text += fmt::format("{}", opacity);
  if (label != nullptr) text += " label " + label->key();
  return text;
}

Result<StyleQuery> complete_style(const StyleQuery& query, const LayerConfig& config) {
  if (auto problem = find_locked(query, config)) return std::move(*problem);
  return query.with_defaults(config.name, config.style);
}

Result<LayerStyle> layer_style(const StyleQuery& style, const ServedLayer& served,
                               std::size_t position, Looking looking) {
  const LayerConfig& config = served.config;
  Making making{LayerSettings(style, config.name), served, served.layer->features(), looking};
  making.fill_opacity = making.settings.value_or(ParameterId::fill_opacity, 1.0);
  making.others = with_opacity(fill_of(making.settings, config, position), making.fill_opacity);
  if (auto problem = make_joined(making)) return std::move(*problem);
  if (auto problem = make_classes(making)) return std::move(*problem);
  if (auto problem = make_selection(making)) return std::move(*problem);
  if (auto problem = check_merge(making)) return std::move(*problem);
  making.style.stroke = stroke_of(making.settings);
  making.style.pattern = pattern_of(making.settings);
  if (auto problem = make_boundary(making)) return std::move(*problem);
  making.style.opacity = making.settings.value_or(ParameterId::opacity, 1.0);
  making.style.units = making.settings.value_or(ParameterId::units, std::string());
  const auto* format = making.settings.find<NumberFormat>(ParameterId::label_format);
  if (format != nullptr) making.style.label_format = *format;
  if (auto problem = make_label(making)) return std::move(*problem);
  make_paints(making);
  return std::move(making.style);
}

double tolerance_in_pixels(const StyleQuery& style, const ServedLayer& layer) {
  if (const auto merge = style.value_for(layer.config.name, ParameterId::merge)) {
    if (layer.merge() > 0) return kTolerancePixels * std::get<double>(*merge) / layer.merge();
  }
  const auto value = style.value_for(layer.config.name, ParameterId::simplify);
  return value ? std::get<double>(*value) : kTolerancePixels;
}

bool names_values(const StyleQuery& style, const std::string& layer) {
  return std::ranges::any_of(style.settings(), [&layer](const StyleSetting& setting) {
    return (setting.layer.empty() || setting.layer == layer) &&
           (std::holds_alternative<TableChoice>(setting.value) ||
            std::holds_alternative<BreakRule>(setting.value));
  });
}

bool has_to_look(const StyleQuery& style, const ServedLayer& served) {
  if (served.derived == nullptr) return false;  // it would have to be computed again
  const LayerSettings settings(style, served.config.name);
  const FeatureTable& features = served.layer->features();
  const auto* choice = settings.find<TableChoice>(ParameterId::values);
  const auto table = choice == nullptr ? nullptr : find_table(*choice, served);
  const int key = table == nullptr ? -1 : field_to_join(settings, *table, features);
  const DerivedValues& derived = *served.derived;
  if (key >= 0 && !derived.has_join(served.revision, key, *table)) return true;
  const auto translation = find_translation(settings, served);
  if (key >= 0 && translation != nullptr && !derived.has_join(served.revision, key, *translation)) {
    return true;
  }
  const ParameterValue* breaks = settings.find_value(ParameterId::breaks);
  const auto* rule = breaks == nullptr ? nullptr : std::get_if<BreakRule>(breaks);
  const auto* property = settings.find<std::string>(ParameterId::color_by);
  if (rule == nullptr || property == nullptr) return false;
  if (key >= 0 && *property == kJoinedName) {
    return !derived.has_breaks(served.revision, *table, key, *rule);
  }
  const int field = features.field_index(*property);
  return field >= 0 && !derived.has_breaks(served.revision, field, *rule);
}

Rgba default_fill(const LayerConfig& config, std::size_t position) {
  const ParameterValue* fill = config.style.find({}, ParameterId::fill);
  if (fill != nullptr) return std::get<Rgba>(*fill);
  return position < kPalette.size() ? kPalette[position] : hue_at(position);
}

}  // namespace trapeze
