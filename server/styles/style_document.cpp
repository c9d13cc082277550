#include "server/styles/style_document.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/base/json_text.h"
#include "server/base/nearest_name.h"

namespace trapeze {
namespace {

// Members of a MapLibre style layer that do not matter here.
constexpr std::array<std::string_view, 4> kIgnored = {"id", "metadata", "source", "source-layer"};

// Looking up a member takes time proportional to their number: this many are read in milliseconds.
// 30 layers with all parameters and 64 classes each have 2800.
constexpr int kMaxMembers = 4096;
constexpr int kMaxDepth = 8;

Problem wrong(std::string detail, std::string parameter = {}, std::string takes = {}) {
  return {400, std::move(detail), std::move(parameter), {}, std::move(takes)};
}

/// The problem is a document that is larger than any style, or that has a member twice: the value
/// would have only one of them. A discarded value if it is not JSON.
Result<Json> parse_json(std::string_view text) {
  int members = 0;
  std::vector<std::set<std::string>> names;  // of the members of open objects, the innermost last
  const auto look = [&](int depth, Json::parse_event_t event, const Json& parsed) {
    const bool is_key = event == Json::parse_event_t::key;
    if ((is_key && ++members > kMaxMembers) || depth > kMaxDepth) {
      throw wrong(
          fmt::format("A style has at most {} members in all, and nothing nested deeper than {}.",
                      kMaxMembers, kMaxDepth));
    }
    if (event == Json::parse_event_t::object_start) names.emplace_back();
    if (event == Json::parse_event_t::object_end) names.pop_back();
    if (is_key && !names.back().insert(parsed.get<std::string>()).second) {
      const auto name = parsed.get<std::string>();
      throw wrong(fmt::format("The member {} is given more than once.", name), name, "one value");
    }
    return true;
  };
  try {
    return Json::parse(text, look, false);
  } catch (const Problem& problem) {
    return problem;
  }
}

std::string class_value_text(std::string_view text) {
  return text == "*" || text == "null" ? std::string(text) : single_quoted(text);
}

/// The value as written in a query; nothing if a query cannot contain it.
std::optional<std::string> scalar_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_unsigned()) return fmt::format("{}", value.get<std::uint64_t>());
  if (value.is_number_integer()) return fmt::format("{}", value.get<std::int64_t>());
  if (value.is_number()) return fmt::format("{}", value.get<double>());
  return std::nullopt;
}

std::optional<std::string> list_text(const Json& list) {
  std::string text;
  for (const Json& item : list) {
    const auto item_text = scalar_text(item);
    if (!item_text) return std::nullopt;
    if (!text.empty()) text.push_back(',');
    text += *item_text;
  }
  return text;
}

std::optional<std::string> classes_text(const Json& classes) {
  std::string text;
  for (const auto& [value, colour] : classes.items()) {
    if (!colour.is_string()) return std::nullopt;
    if (!text.empty()) text.push_back(',');
    text += class_value_text(value) + ":" + colour.get<std::string>();
  }
  return text;
}

std::optional<std::string> value_text(const StyleParameter& parameter, const Json& value) {
  if (value.is_array()) return list_text(value);
  if (value.is_object() && parameter.type == ParameterType::classes) return classes_text(value);
  return scalar_text(value);
}

/// Collects query pairs from a document.
class DocumentReader {
 public:
  std::optional<Problem> read(const Json& object, const std::string& layer) {
    for (const auto& [key, value] : object.items()) {
      if (auto problem = read_member(key, value, layer)) return problem;
    }
    // In MapLibre, the opacity of the fill is also that of its outline.
    if (!object.contains("fill-outline-color") || !object.contains("fill-opacity") ||
        object.contains("stroke-opacity")) {
      return std::nullopt;
    }
    return add("stroke-opacity", object["fill-opacity"], layer);
  }

  Result<StyleQuery> finish() const { return StyleQuery::parse(pairs_, layers_); }

 private:
  std::optional<Problem> read_member(const std::string& key, const Json& value,
                                     const std::string& layer) {
    if (key == "paint" && value.is_object()) return read(value, layer);
    if (key == "fill-color") return add("fill", value, layer);
    if (key == "fill-outline-color") return add("stroke", value, layer);
    if (key == "fill-antialias" && value.is_boolean() && value.get<bool>()) return std::nullopt;
    if (std::ranges::find(kIgnored, key) != kIgnored.end()) return std::nullopt;
    if (key == "type" && value == "fill") return std::nullopt;
    if (key == "layers" && value.is_object() && layer.empty()) return read_layers(value);
    const std::size_t dot = key.find('.');
    if (dot == std::string::npos || !layer.empty()) return add(key, value, layer);
    return add(key.substr(dot + 1), value, key.substr(0, dot));
  }

  std::optional<Problem> read_layers(const Json& layers) {
    for (const auto& [layer, style] : layers.items()) {
      if (!style.is_object()) return wrong(fmt::format("The layer {} needs an object.", layer));
      if (auto problem = read(style, layer)) return problem;
    }
    return std::nullopt;
  }

  std::optional<Problem> add(const std::string& name, const Json& value, const std::string& layer) {
    const StyleParameter* parameter = find_style_parameter(name);
    if (parameter == nullptr || parameter->id == ParameterId::style ||
        (!layer.empty() && !parameter->is_per_layer)) {
      return unknown(name, layer);
    }
    if (!layer.empty() && !is_url_name(layer)) {
      return wrong(fmt::format("\"{}\" cannot name a layer.", layer), "layers", "layer names");
    }
    auto text = value_text(*parameter, value);
    if (!text) {
      const std::string takes = describe_values(*parameter);
      return wrong(fmt::format("The parameter {} takes {}.", name, takes), name, takes);
    }
    if (!layer.empty() && std::ranges::find(layers_, layer) == layers_.end()) {
      layers_.push_back(layer);
    }
    pairs_.emplace_back(layer.empty() ? name : layer + "." + name, std::move(*text));
    return std::nullopt;
  }

  static Problem unknown(const std::string& name, const std::string& layer) {
    std::vector<std::string> known;
    for (const StyleParameter& parameter : style_parameters()) {
      if (parameter.id == ParameterId::style || (!layer.empty() && !parameter.is_per_layer)) {
        continue;
      }
      known.emplace_back(parameter.name);
    }
    return wrong(
        fmt::format("A style does not know \"{}\"{}{}", name, layer.empty() ? "" : " for one layer",
                    suggestion_or_stop(name, known)),
        name, fmt::format("{}", fmt::join(known, ", ")));
  }

  std::vector<QueryPair> pairs_;
  std::vector<std::string> layers_;
};

}  // namespace

Result<StyleQuery> parse_style_document(std::string_view text) {
  const Result<Json> parsed = parse_json(text);
  if (!parsed) return parsed.problem();
  const Json& json = *parsed;
  if (!json.is_object()) {
    return wrong(json.is_discarded() ? "The body is not JSON."
                                     : "A style is a JSON object with parameters as members.");
  }
  DocumentReader reader;
  if (auto problem = reader.read(json, {})) return std::move(*problem);
  return reader.finish();
}

std::string style_document(const StyleQuery& style) {
  Json json = Json::object();
  for (const StyleSetting& setting : style.settings()) {
    Json& place = setting.layer.empty() ? json : json["layers"][setting.layer];
    Json& value = place[std::string(style_parameter(setting.parameter).name)];
    if (const auto* number = std::get_if<double>(&setting.value)) {
      value = *number;
    } else {
      value = format_value(setting.value);
    }
  }
  return to_text(json);
}

}  // namespace trapeze
