#include "server/tiles/layer_style.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "server/styles/colour_ramps.h"

namespace trapeze {
namespace {

// Colours of layers that were given none: muted, told apart, readable over each other.
constexpr std::array<Rgba, 8> kPalette = {{{0x7f, 0xa6, 0x87, 255},
                                           {0x6f, 0xa8, 0xc9, 255},
                                           {0xd9, 0x9b, 0x6c, 255},
                                           {0x9d, 0x87, 0xb8, 255},
                                           {0xd7, 0xb9, 0x5b, 255},
                                           {0xc6, 0x7b, 0x82, 255},
                                           {0x62, 0xa6, 0xa0, 255},
                                           {0x94, 0x8b, 0x80, 255}}};
/// The colour of the layer at `position` after those of the palette: hues at the golden angle,
/// which stay apart however many there are.
Rgba hue_at(std::size_t position) {
  constexpr double kGoldenAngle = 137.50776405003785;
  constexpr double kMiddle = 158;  // of the channels, and how far they go from it
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

/// The settings of a query as they hold for one layer.
class LayerSettings {
 public:
  LayerSettings(const StyleQuery& query, const std::string& layer) : query_(query), layer_(layer) {}

  template <typename T>
  const T* find(ParameterId id) const {
    const ParameterValue* value = query_.find(layer_, id);
    return value == nullptr ? nullptr : &std::get<T>(*value);
  }
  bool has(ParameterId id) const { return query_.find(layer_, id) != nullptr; }

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
  if (stroke.dashes.size() % 2 == 1) {  // as in SVG: the list twice
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

/// What is wrong about which of the four are set.
std::optional<Problem> find_contradiction(const LayerSettings& settings) {
  const bool has_classes = settings.has(ParameterId::classes);
  const bool has_breaks = settings.has(ParameterId::breaks);
  const bool has_ramp = settings.has(ParameterId::ramp);
  if (has_classes && (has_breaks || has_ramp)) {
    return contradiction("Colours come either from classes, or from breaks with a ramp.",
                         ParameterId::classes, settings, "neither breaks nor ramp beside it");
  }
  if (has_breaks != has_ramp) {
    return contradiction("Breaks part the numbers, a ramp colours them: each needs the other.",
                         has_breaks ? ParameterId::breaks : ParameterId::ramp, settings,
                         has_breaks ? "ramp beside it" : "breaks beside it");
  }
  const bool has_rules = has_classes || has_breaks;
  if (has_rules && !settings.has(ParameterId::color_by)) {
    return contradiction("Classes need a property: color-by.",
                         has_classes ? ParameterId::classes : ParameterId::breaks, settings,
                         "color-by beside it");
  }
  if (!has_rules && settings.has(ParameterId::color_by)) {
    return contradiction("A property to colour by needs classes, or breaks with a ramp.",
                         ParameterId::color_by, settings, "classes, or breaks and ramp, beside it");
  }
  return std::nullopt;
}

template <typename Number>
std::optional<FilterLiteral> read_number(const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return FilterLiteral(number);
}

/// The value as the type of the field has it; nothing if it cannot be one.
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

/// What a layer's style is made of, step by step.
struct Making {
  LayerSettings settings;
  const FeatureTable& features;
  double fill_opacity = 1;
  Rgba others = kTransparent;  // with the opacity already
  LayerStyle style = {};
  std::vector<Rgba> fills = {};  // of the classes by value
};

/// Many values in few colours are as few passes as there are colours.
void make_alike(Making& making) {
  std::vector<std::uint8_t> alike;
  for (const Rgba fill : making.fills) {
    const auto first = std::ranges::find(making.fills, fill);
    alike.push_back(static_cast<std::uint8_t>(first - making.fills.begin()));
  }
  making.style.classing.alike = std::move(alike);
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
        const std::string takes =
            field.type == FieldType::integer ? "integers as values" : "numbers as values";
        return Problem{400,
                       fmt::format("The property {} holds numbers, and \"{}\" is none of them.",
                                   field.name, wanted.value),
                       "classes", wanted.value, takes};
      }
    }
    making.style.classing.values.push_back(std::move(value));
    making.fills.push_back(colour);
  }
  make_alike(making);
  return std::nullopt;
}

std::optional<Problem> make_breaks(Making& making, const Field& field) {
  const LayerSettings& settings = making.settings;
  if (field.type == FieldType::text) {
    return Problem{400,
                   fmt::format("The property {} holds text, which breaks cannot part.", field.name),
                   "color-by", field.name, "a property of numbers, or classes instead of breaks"};
  }
  const auto& breaks = *settings.find<std::vector<double>>(ParameterId::breaks);
  const auto& ramp = *settings.find<std::string>(ParameterId::ramp);
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
  const int number = making.features.field_index(*property);
  if (number < 0) return unknown_property("color-by", *property, making.features);
  making.style.classing.field = number;
  const Field& field = making.features.fields()[static_cast<std::size_t>(number)];
  return making.settings.has(ParameterId::classes) ? make_values(making, field)
                                                   : make_breaks(making, field);
}

std::optional<Problem> make_selection(Making& making) {
  Classing& classing = making.style.classing;
  using Ids = std::vector<std::int64_t>;
  classing.ids = making.settings.value_or(ParameterId::ids, Ids());
  classing.highlighted_ids = making.settings.value_or(ParameterId::highlight, Ids());
  const auto* filter = making.settings.find<std::shared_ptr<const Filter>>(ParameterId::filter);
  if (filter == nullptr) return std::nullopt;
  auto bound = BoundFilter::bind(*filter, making.features);
  if (!bound) return std::move(bound).problem();
  classing.filter = std::make_shared<const BoundFilter>(*std::move(bound));
  return std::nullopt;
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
  return text + fmt::format("{}", opacity);
}

Result<StyleQuery> complete_style(const StyleQuery& query, const LayerConfig& config) {
  if (auto problem = find_locked(query, config)) return std::move(*problem);
  return query.with_defaults(config.name, config.style);
}

Result<LayerStyle> layer_style(const StyleQuery& style, const ServedLayer& served,
                               std::size_t position) {
  const LayerConfig& config = served.config;
  Making making{LayerSettings(style, config.name), served.layer->features()};
  making.fill_opacity = making.settings.value_or(ParameterId::fill_opacity, 1.0);
  making.others = with_opacity(fill_of(making.settings, config, position), making.fill_opacity);
  if (auto problem = make_classes(making)) return std::move(*problem);
  if (auto problem = make_selection(making)) return std::move(*problem);
  making.style.stroke = stroke_of(making.settings);
  making.style.pattern = pattern_of(making.settings);
  making.style.opacity = making.settings.value_or(ParameterId::opacity, 1.0);
  make_paints(making);
  return std::move(making.style);
}

Rgba default_fill(const LayerConfig& config, std::size_t position) {
  const ParameterValue* fill = config.style.find({}, ParameterId::fill);
  if (fill != nullptr) return std::get<Rgba>(*fill);
  return position < kPalette.size() ? kPalette[position] : hue_at(position);
}

}  // namespace trapeze
