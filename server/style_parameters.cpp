#include "server/style_parameters.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <tuple>

namespace trapeze {
namespace {

// The greatest tolerance that a request may ask for: half the side of a tile would leave nothing.
constexpr double kMaxSimplify = 64;

constexpr std::array kParameters = {
    StyleParameter{ParameterId::background,
                   "background",
                   ParameterType::colour,
                   0,
                   0,
                   {},
                   "transparent",
                   false,
                   "colour of the tile below all layers"},
    StyleParameter{ParameterId::debug, "debug", ParameterType::words, 0, 0, "mesh tile vertices",
                   "nothing", false,
                   "what to draw over the tile: the trapezoids, the border of the tile with its "
                   "numbers, the vertices that are kept"},
    StyleParameter{ParameterId::fill,
                   "fill",
                   ParameterType::colour,
                   0,
                   0,
                   {},
                   "the layer's own colour",
                   true,
                   "colour of the polygons"},
    StyleParameter{ParameterId::fill_opacity,
                   "fill-opacity",
                   ParameterType::number,
                   0,
                   1,
                   {},
                   "the layer's own opacity",
                   true,
                   "opacity of the polygons, multiplied with that of their colour"},
    StyleParameter{ParameterId::simplify,
                   "simplify",
                   ParameterType::number,
                   0,
                   kMaxSimplify,
                   {},
                   "0.25",
                   true,
                   "how far the drawn boundary may be from the true one, in pixels of the picture; "
                   "0 draws every vertex"},
    StyleParameter{ParameterId::small, "small", ParameterType::word, 0, 0, "drop dust keep", "dust",
                   true,
                   "polygons too small for the tolerance: dust keeps their area as a tint, keep "
                   "draws each at least a pixel large, drop leaves them out"},
    StyleParameter{ParameterId::topology, "topology", ParameterType::word, 0, 0, "fast strict",
                   "strict", true,
                   "strict keeps boundaries from crossing each other, fast simplifies without that "
                   "test"},
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
  // Written so that NaN fails; adding 0 turns -0 into 0, which would be a second way to say it.
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

std::optional<ParameterValue> parse_word(std::string_view text, std::string_view words) {
  const auto known = split(words, ' ');
  if (std::ranges::find(known, text) == known.end()) return std::nullopt;
  return std::string(text);
}

/// The canonical form has each word once, in the order of the table.
std::optional<ParameterValue> parse_words(std::string_view text, std::string_view words) {
  const auto known = split(words, ' ');
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

std::string format_value(const ParameterValue& value) {
  if (const auto* colour = std::get_if<Rgba>(&value)) return to_hex(*colour);
  if (const auto* words = std::get_if<std::string>(&value)) return *words;
  return fmt::format("{}", std::get<double>(value));  // the shortest text that reads back the same
}

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

/// The parameter is null for a name that means nothing to these layers.
SettingName resolve_name(std::string_view name, std::span<const std::string> layers) {
  const std::size_t dot = name.find('.');
  if (dot == std::string_view::npos) return {{}, find_style_parameter(name)};
  const std::string_view layer = name.substr(0, dot);
  if (std::ranges::find(layers, layer) == layers.end()) return {};
  const StyleParameter* parameter = find_style_parameter(name.substr(dot + 1));
  if (parameter == nullptr || !parameter->is_per_layer) return {};
  return {layer, parameter};
}

}  // namespace

std::span<const StyleParameter> style_parameters() {
  return kParameters;
}

const StyleParameter& style_parameter(ParameterId id) {
  return kParameters[static_cast<std::size_t>(id)];
}

const StyleParameter* find_style_parameter(std::string_view name) {
  const auto found = std::ranges::find(kParameters, name, &StyleParameter::name);
  return found == kParameters.end() ? nullptr : &*found;
}

std::optional<ParameterValue> parse_parameter(const StyleParameter& parameter,
                                              std::string_view text) {
  switch (parameter.type) {
    case ParameterType::colour:
      return parse_colour(text);
    case ParameterType::number:
      return parse_number(text, parameter.min, parameter.max);
    case ParameterType::word:
      return parse_word(text, parameter.words);
    case ParameterType::words:
      return parse_words(text, parameter.words);
  }
  return std::nullopt;
}

std::string describe_values(const StyleParameter& parameter) {
  switch (parameter.type) {
    case ParameterType::colour:
      return "a colour: hex digits without # (rgb, rgba, rrggbb or rrggbbaa), a CSS name, "
             "rgb(r,g,b) or rgba(r,g,b,a)";
    case ParameterType::number:
      return fmt::format("a number from {} to {}", parameter.min, parameter.max);
    case ParameterType::word:
      return fmt::format("one of {}", fmt::join(split(parameter.words, ' '), ", "));
    case ParameterType::words:
      return fmt::format("some of {}, separated by commas",
                         fmt::join(split(parameter.words, ' '), ", "));
  }
  return {};
}

OrProblem<StyleQuery> StyleQuery::parse(std::span<const QueryPair> pairs,
                                        std::span<const std::string> layers) {
  StyleQuery query;
  for (const auto& [name, text] : pairs) {
    const auto [layer, parameter] = resolve_name(name, layers);
    if (parameter == nullptr) continue;
    const std::string takes = describe_values(*parameter);
    if (query.find(layer, parameter->id) != nullptr) {
      return Problem{400, fmt::format("The parameter {} is given more than once.", name), name,
                     text, takes + ", once"};
    }
    const auto value = parse_parameter(*parameter, text);
    if (!value) {
      return Problem{400, fmt::format("The parameter {} takes {}.", name, takes), name, text,
                     takes};
    }
    query.settings_.push_back({std::string(layer), parameter->id, *value});
  }
  std::ranges::sort(query.settings_, {}, order_of);
  return query;
}

std::optional<ParameterValue> StyleQuery::value_for(std::string_view layer,
                                                    ParameterId parameter) const {
  const StyleSetting* setting = find(layer, parameter);
  if (setting == nullptr) setting = find({}, parameter);
  if (setting == nullptr) return std::nullopt;
  return setting->value;
}

std::string StyleQuery::canonical_text() const {
  std::string text;
  for (const StyleSetting& setting : settings_) {
    if (!text.empty()) text.push_back('&');
    text += written_name(setting) + '=' + percent_encode(format_value(setting.value));
  }
  return text;
}

const StyleSetting* StyleQuery::find(std::string_view layer, ParameterId parameter) const {
  const auto found = std::ranges::find_if(settings_, [&](const StyleSetting& setting) {
    return setting.layer == layer && setting.parameter == parameter;
  });
  return found == settings_.end() ? nullptr : &*found;
}

}  // namespace trapeze
