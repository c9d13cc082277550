#include "server/config/config_print.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/io/source/source_name.h"
#include "server/base/json_text.h"
#include "server/config/config_settings.h"
#include "server/styles/style_parameters.h"

namespace trapeze {
namespace {

constexpr std::size_t kCommentColumn = 40;

/// A basic string of TOML, escaped so that ${NAME} in it is not expanded when it is read.
std::string toml_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (c == '$') quoted += '$';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      quoted += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string toml_text(const SettingValue& value) {
  if (const auto* boolean = std::get_if<bool>(&value)) return *boolean ? "true" : "false";
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  if (const auto* text = std::get_if<std::string>(&value)) return toml_string(*text);
  std::string items;
  for (const std::string& item : std::get<std::vector<std::string>>(value)) {
    items += (items.empty() ? "" : ", ") + toml_string(item);
  }
  return "[" + items + "]";
}

std::string line(const std::string& key, const std::string& value, const LoadedConfig& loaded,
                 const std::string& setting) {
  const std::string assignment = fmt::format("{} = {}", key, value);
  return fmt::format("{:<{}} # {}\n", assignment, kCommentColumn, loaded.origin_of(setting));
}

/// The settings of a style as keys and values; settings for single layers have dotted keys.
std::vector<std::string> style_assignments(const StyleQuery& style) {
  std::vector<std::string> assignments;
  for (const auto& [name, value] : style.pairs()) {
    assignments.push_back(fmt::format("{} = {}", name, toml_string(value)));
  }
  return assignments;
}

std::string print_style(const StyleQuery& style) {
  return fmt::format("style = {{ {} }}\n", fmt::join(style_assignments(style), ", "));
}

std::string print_named_style(const std::string& name, const StyleQuery& style) {
  return fmt::format("\n[styles.{}]\n{}\n", name, fmt::join(style_assignments(style), "\n"));
}

std::string print_value_table(const std::string& name, const ValueTableConfig& table,
                              const LoadedConfig& loaded) {
  std::string text = fmt::format("\n[values.{}]\n", name);
  for (const auto& setting : value_table_settings()) {
    text += line(setting.key, toml_text(setting.get(table)), loaded,
                 fmt::format("values.{}.{}", name, setting.key));
  }
  return text;
}

std::string print_fonts(const std::string& name, const FontsConfig& fonts,
                        const LoadedConfig& loaded) {
  std::string text = fmt::format("\n[fonts.{}]\n", name);
  for (const auto& setting : fonts_settings()) {
    text += line(setting.key, toml_text(setting.get(fonts)), loaded,
                 fmt::format("fonts.{}.{}", name, setting.key));
  }
  return text;
}

/// Removes the password that a connection string may contain.
SettingValue without_password(const Setting<LayerConfig>& setting, const SettingValue& value) {
  if (setting.type != SettingType::path) return value;
  return name_of_source(std::get<std::string>(value));
}

std::string print_layer(const LayerConfig& layer, const LoadedConfig& loaded) {
  std::string text = "\n[[layer]]\n";
  for (const auto& setting : layer_settings()) {
    const SettingValue value = setting.get(layer);
    const bool is_unset = value == SettingValue(std::string());
    if (is_unset) continue;
    text += line(setting.key, toml_text(without_password(setting, value)), loaded,
                 fmt::format("layer.{}.{}", layer.name, setting.key));
  }
  return text + print_style(layer.style);
}

Json default_json(const SettingValue& value) {
  return std::visit([](const auto& plain) { return Json(plain); }, value);
}

Json type_schema(SettingType type) {
  switch (type) {
    case SettingType::boolean:
      return {{"type", "boolean"}};
    case SettingType::integer:
      return {{"type", "integer"}};
    case SettingType::number:
      return {{"type", "number"}};
    case SettingType::text:
    case SettingType::path:
      return {{"type", "string"}};
    case SettingType::amount:
      return {{"type", {"integer", "string"}}, {"minimum", 0}, {"pattern", "^[0-9.]+ ?%?$"}};
    case SettingType::list:
    case SettingType::paths:
      return {{"type", "array"}, {"items", {{"type", "string"}}}};
  }
  return {};
}

template <typename Owner>
Json setting_schema(const Setting<Owner>& setting) {
  Json schema = type_schema(setting.type);
  schema["description"] = setting.help;
  if (setting.type == SettingType::integer) {
    schema["minimum"] = static_cast<std::int64_t>(setting.min);
    schema["maximum"] = static_cast<std::int64_t>(setting.max);
  } else if (setting.type == SettingType::number) {
    schema["minimum"] = setting.min;
    schema["maximum"] = setting.max;
  } else if (setting.type == SettingType::text && !setting.choices.empty()) {
    schema["enum"] = setting.choices;
  }
  const SettingValue value = setting.get(Owner{});
  const bool is_unset = std::is_same_v<Owner, LayerConfig> && value == SettingValue(std::string());
  if (!is_unset) schema["default"] = default_json(value);
  return schema;
}

Json closed_object() {
  return {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
}

/// Style parameters, in whose names '_' may replace '-'.
Json style_schema(bool is_for_all_layers) {
  Json schema = closed_object();
  for (const StyleParameter& parameter : style_parameters()) {
    if (parameter.id == ParameterId::style) continue;
    if (!parameter.is_per_layer && !is_for_all_layers) continue;
    const Json value = {{"type", {"string", "number", "array"}},
                        {"description", describe_values(parameter)}};
    std::string name(parameter.name);
    schema["properties"][name] = value;
    std::ranges::replace(name, '-', '_');
    schema["properties"][name] = value;
  }
  return schema;
}

/// Styles by name, with tables for single layers.
Json styles_schema() {
  Json style = style_schema(true);
  style["additionalProperties"] = style_schema(false);
  return {{"type", "object"},
          {"description", "named styles, for style=NAME"},
          {"propertyNames", {{"pattern", "^[A-Za-z0-9_-]{1,64}$"}}},
          {"additionalProperties", style}};
}

Json fonts_schema() {
  Json table = closed_object();
  for (const auto& setting : fonts_settings()) {
    table["properties"][setting.key] = setting_schema(setting);
  }
  table["required"] = {"files"};
  return {{"type", "object"},
          {"description", "named fonts, for label-font=NAME"},
          {"propertyNames", {{"pattern", "^[A-Za-z0-9_-]{1,64}$"}}},
          {"additionalProperties", table}};
}

Json value_tables_schema() {
  Json table = closed_object();
  for (const auto& setting : value_table_settings()) {
    table["properties"][setting.key] = setting_schema(setting);
  }
  table["required"] = {"file"};
  return {{"type", "object"},
          {"description", "named value tables, for values=NAME"},
          {"propertyNames", {{"pattern", "^[A-Za-z0-9_-]{1,64}$"}}},
          {"additionalProperties", table}};
}

Json layer_schema() {
  Json schema = closed_object();
  for (const auto& setting : layer_settings()) {
    schema["properties"][setting.key] = setting_schema(setting);
  }
  schema["properties"]["name"]["pattern"] = "^[A-Za-z0-9_-]{1,64}$";
  schema["properties"]["style"] = style_schema(false);
  schema["properties"]["style"]["description"] = "the default style of the layer";
  schema["required"] = {"name"};
  schema["anyOf"] = {{{"required", {"file"}}}, {{"required", {"prepared"}}}};
  return schema;
}

}  // namespace

std::string print_config(const LoadedConfig& loaded) {
  std::string text;
  std::string table;
  for (const auto& setting : config_settings()) {
    if (setting.table != table) {
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", setting.table);
      table = setting.table;
    }
    text += line(setting.key, toml_text(setting.get(loaded.config)), loaded, setting.name());
  }
  for (const auto& [name, style] : loaded.config.styles) text += print_named_style(name, style);
  for (const auto& [name, fonts] : loaded.config.fonts) text += print_fonts(name, fonts, loaded);
  for (const auto& [name, values] : loaded.config.values) {
    text += print_value_table(name, values, loaded);
  }
  for (const LayerConfig& layer : loaded.config.layers) text += print_layer(layer, loaded);
  return text;
}

std::string config_schema() {
  Json schema;
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["title"] = "Configuration of Trapeze";
  schema["type"] = "object";
  schema["additionalProperties"] = false;
  schema["properties"] = Json::object();
  for (const auto& setting : config_settings()) {
    Json& table = schema["properties"][setting.table];
    if (table.is_null()) table = closed_object();
    table["properties"][setting.key] = setting_schema(setting);
  }
  schema["properties"]["styles"] = styles_schema();
  schema["properties"]["fonts"] = fonts_schema();
  schema["properties"]["values"] = value_tables_schema();
  schema["properties"]["layer"] = {{"type", "array"},
                                   {"description", "the layers, the bottom layer first"},
                                   {"items", layer_schema()}};
  return to_text(schema);
}

}  // namespace trapeze
