#include "server/config/load_config.h"

#include <spdlog/fmt/fmt.h>
#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/io/source/target_grid.h"
#include "server/base/nearest_name.h"
#include "server/base/url.h"
#include "server/config/config_settings.h"
#include "server/config/expand_variables.h"
#include "server/styles/style_book.h"
#include "server/styles/style_parameters.h"

namespace trapeze {
namespace {

constexpr std::string_view kVariablePrefix = "TRAPEZE_";

std::string position_text(const std::string& path, const toml::source_position& position) {
  return fmt::format("{}:{}:{}", path, position.line, position.column);
}

std::string name_of_item(const std::string& setting, std::size_t item) {
  return fmt::format("{}[{}]", setting, item);
}

std::string relative_to_config(const std::string& config_path, const std::string& path) {
  if (!is_file_path(path)) return path;
  return (std::filesystem::path(config_path).parent_path() / path).lexically_normal().string();
}

/// Sets the value, which has the right type, if the setting accepts it; returns whether it does.
template <typename Owner>
bool assign(const Setting<Owner>& setting, Owner& owner, const SettingValue& value) {
  const auto is_within = [&setting](double number) {
    return number >= setting.min && number <= setting.max;  // false for NaN
  };
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    if (!is_within(static_cast<double>(*integer))) return false;
  }
  if (const auto* number = std::get_if<double>(&value); number && !is_within(*number)) return false;
  return setting.set(owner, value);
}

/// Turns TOML tables into settings, and continues after errors.
class ConfigReader {
 public:
  ConfigReader(const std::string& path, LoadedConfig& loaded) : path_(path), loaded_(loaded) {}

  void read(const toml::table& root) {
    for (const auto& [key, node] : root) {
      if (key.str() == "layer") {
        read_layers(node);
      } else if (key.str() == "styles") {
        read_styles(node);
      } else if (key.str() == "values") {
        read_value_tables(node);
      } else if (key.str() == "fonts") {
        read_fonts(node);
      } else if (is_table_of_settings(key.str())) {
        read_table(key.str(), node);
      } else {
        fail(key.source().begin,
             fmt::format(
                 "unknown key {}; allowed here are server, viewer, limits, text, log, "
                 "admin, changes, styles, fonts, values, layer{}",
                 key.str(),
                 did_you_mean(key.str(), {"server", "viewer", "limits", "text", "log", "admin",
                                          "changes", "styles", "fonts", "values", "layer"})));
      }
    }
    sort_problems();
  }

 private:
  void fail(const toml::source_position& position, std::string what) {
    loaded_.problems.push_back({position_text(path_, position), std::move(what)});
    positions_.push_back(position);
  }
  void fail(const toml::node& node, std::string what) {
    fail(node.source().begin, std::move(what));
  }

  /// In the order of the file: the keys of a table are visited in alphabetical order.
  void sort_problems() {
    std::vector<std::size_t> order(positions_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(
        order, [this](std::size_t a, std::size_t b) { return positions_[a] < positions_[b]; });
    std::vector<ConfigProblem> sorted;
    sorted.reserve(order.size());
    for (const std::size_t i : order) sorted.push_back(std::move(loaded_.problems[i]));
    loaded_.problems = std::move(sorted);
  }

  static bool is_table_of_settings(std::string_view name) {
    return std::ranges::find(config_settings(), name, &Setting<Config>::table) !=
           config_settings().end();
  }

  void read_table(std::string_view name, const toml::node& node) {
    const toml::table* table = node.as_table();
    if (table == nullptr) {
      return fail(node, fmt::format("{} takes a table, begun by [{}]", name, name));
    }
    std::vector<Setting<Config>> here;
    std::ranges::copy_if(config_settings(), std::back_inserter(here),
                         [name](const auto& setting) { return setting.table == name; });
    read_settings(*table, here, loaded_.config, std::string(name));
  }

  /// `other_key` is read elsewhere.
  template <typename Owner>
  void read_settings(const toml::table& table, const std::vector<Setting<Owner>>& settings,
                     Owner& owner, const std::string& name, std::string_view other_key = {}) {
    for (const auto& [key, node] : table) {
      if (!other_key.empty() && key.str() == other_key) continue;
      const auto setting = std::ranges::find(settings, key.str(), &Setting<Owner>::key);
      if (setting == settings.end()) {
        fail_unknown(key, settings, name, other_key);
      } else if (read_setting(*setting, node, owner)) {
        keep_origin(name + "." + setting->key, node);
      }
    }
  }

  void keep_origin(const std::string& setting, const toml::node& node) {
    loaded_.origins[setting] = position_text(path_, node.source().begin);
    const toml::array* items = node.as_array();
    for (std::size_t i = 0; items != nullptr && i < items->size(); ++i) {
      keep_origin(name_of_item(setting, i), (*items)[i]);
    }
  }

  template <typename Owner>
  void fail_unknown(const toml::key& key, const std::vector<Setting<Owner>>& settings,
                    const std::string& name, std::string_view other_key) {
    std::vector<std::string> allowed;
    allowed.reserve(settings.size() + 1);
    for (const auto& setting : settings) allowed.emplace_back(setting.key);
    if (!other_key.empty()) allowed.emplace_back(other_key);
    fail(key.source().begin,
         fmt::format("unknown key {}.{}; allowed here are {}{}", name, key.str(),
                     fmt::join(allowed, ", "), did_you_mean(key.str(), allowed)));
  }

  template <typename Owner>
  bool read_setting(const Setting<Owner>& setting, const toml::node& node, Owner& owner) {
    const std::size_t before = loaded_.problems.size();
    const auto value = value_of(setting.type, node);
    if (loaded_.problems.size() > before) return false;  // a variable is not set
    if (value && assign(setting, owner, with_path(setting, *value))) return true;
    const toml::node* item = value ? refused_item(setting, node, owner) : nullptr;
    fail(item == nullptr ? node : *item, fmt::format("{} takes {}", setting.name(), setting.takes));
    return false;
  }

  /// The first invalid item of a list; null if it is not a list.
  template <typename Owner>
  const toml::node* refused_item(const Setting<Owner>& setting, const toml::node& node,
                                 Owner owner) {
    const toml::array* array = node.as_array();
    if (array == nullptr) return nullptr;
    const auto refused = std::ranges::find_if(*array, [&](const toml::node& item) {
      return !setting.set(owner, std::vector<std::string>{expanded(item)});
    });
    return refused == array->end() ? nullptr : &*refused;
  }

  template <typename Owner>
  SettingValue with_path(const Setting<Owner>& setting, const SettingValue& value) const {
    if (setting.type == SettingType::paths) {
      auto paths = std::get<std::vector<std::string>>(value);
      for (std::string& path : paths) path = relative_to_config(path_, path);
      return paths;
    }
    if (setting.type != SettingType::path) return value;
    const auto& text = std::get<std::string>(value);
    const bool is_word = std::ranges::find(setting.choices, text) != setting.choices.end();
    return is_word ? value : SettingValue(relative_to_config(path_, text));
  }

  /// Nothing if the node has another type.
  std::optional<SettingValue> value_of(SettingType type, const toml::node& node) {
    switch (type) {
      case SettingType::boolean:
        return node.is_boolean() ? std::optional<SettingValue>(node.as_boolean()->get())
                                 : std::nullopt;
      case SettingType::integer:
        return node.is_integer() ? std::optional<SettingValue>(node.as_integer()->get())
                                 : std::nullopt;
      case SettingType::number:
        return node.is_number() ? std::optional<SettingValue>(*node.value<double>()) : std::nullopt;
      case SettingType::text:
      case SettingType::path:
        return node.is_string() ? std::optional<SettingValue>(expanded(node)) : std::nullopt;
      case SettingType::amount:
        if (node.is_integer()) return std::to_string(node.as_integer()->get());
        return node.is_string() ? std::optional<SettingValue>(expanded(node)) : std::nullopt;
      case SettingType::list:
      case SettingType::paths:
        return list_of(node);
    }
    return std::nullopt;
  }

  std::optional<SettingValue> list_of(const toml::node& node) {
    const toml::array* array = node.as_array();
    if (array == nullptr) return std::nullopt;
    std::vector<std::string> items;
    for (const toml::node& item : *array) {
      if (!item.is_string()) return std::nullopt;
      items.push_back(expanded(item));
    }
    return items;
  }

  static ExpandedText with_variables(const toml::node& node) {
    const auto variable = [](const std::string& name) { return std::getenv(name.c_str()); };
    return expand_variables(node.as_string()->get(), variable);
  }

  std::string expanded(const toml::node& node) {
    auto text = with_variables(node);
    if (!text.problem.empty()) fail(node, text.problem);
    return std::move(text.text);
  }

  void read_layers(const toml::node& node) {
    const toml::array* array = node.as_array();
    if (array == nullptr) return fail(node, "layers are tables, each begun by [[layer]]");
    for (const toml::node& item : *array) {
      const toml::table* table = item.as_table();
      if (table == nullptr) {
        fail(item, "layers are tables, each begun by [[layer]]");
      } else {
        read_layer(*table);
      }
    }
  }

  void read_layer(const toml::table& table) {
    LayerConfig layer;
    const toml::node* written = table.get("name");
    // As in layer.name, under which others look for origins.
    const std::string called =
        written != nullptr && written->is_string() ? with_variables(*written).text : "";
    const std::string name = called.empty() ? "layer" : "layer." + called;
    const std::size_t before = loaded_.problems.size();
    read_settings(table, layer_settings(), layer, name, "style");
    if (const toml::node* style = table.get("style")) {
      layer.style = read_layer_style(*style);
      keep_origin(name + ".style", *style);
    }
    if (table.get("name") == nullptr) {
      fail(table, "every [[layer]] needs a name of 1 to 64 letters, digits, '_' or '-'");
    }
    const bool is_readable = loaded_.problems.size() == before;
    if (is_readable && layer.file_to_open().empty()) {
      fail(table, fmt::format("layer \"{}\" needs a file", layer.name));
    }
    if (!layer.prepared.empty() && !layer.selection.is_all()) {
      fail(table,
           fmt::format("layer \"{}\" is prepared: select from its source with the options of "
                       "`trapeze prepare`, and not by source_layer, where or attributes",
                       layer.name));
    }
    if (!layer.live_query.empty()) check_live(table, layer);
    check_crs(table, layer);
    if (!layer.merge_by.empty() && layer.merge.value_or(0) == 0) {
      fail(*table.get("merge_by"),
           fmt::format("layer \"{}\": merge_by needs merge, the distance up to which polygons "
                       "become one block",
                       layer.name));
    }
    if (layer.min_zoom > layer.max_zoom) {
      fail(table, fmt::format("layer \"{}\" has a min_zoom above its max_zoom", layer.name));
    }
    if (layer.title.empty()) layer.title = layer.name;
    keep(std::move(layer), table.source().begin);
  }

  void check_live(const toml::table& table, const LayerConfig& layer) {
    const auto cannot = [&](const char* why) {
      fail(table, fmt::format("layer \"{}\" cannot have a live_query: {}", layer.name, why));
    };
    if (!layer.prepared.empty()) cannot("it is prepared");
    if (layer.selection.layer.empty()) cannot("it needs a source_layer, the table to query");
    if (layer.has_fast_topology()) cannot("a layer without the topology test is built whole");
    if (layer.merge.value_or(0) > 0) cannot("a layer that is merged into blocks is built whole");
  }

  void check_crs(const toml::table& table, LayerConfig& layer) {
    if (layer.crs.empty()) return;
    const toml::node& node = table.get("crs") == nullptr ? table : *table.get("crs");
    const auto cannot = [&](const std::string& why) {
      fail(node, fmt::format("layer \"{}\": crs: {}", layer.name, why));
    };
    if (std::ranges::find(layer.crs, kBuiltCrs) == layer.crs.end()) {
      cannot(
          fmt::format("{} must be in the list: locations and bounds are given in it", kBuiltCrs));
    }
    for (auto name = layer.crs.begin(); name != layer.crs.end(); ++name) {
      if (std::find(layer.crs.begin(), name, *name) != name) cannot(*name + " is named twice");
      if (*name == kBuiltCrs) continue;
      if (*name == "EPSG:4326" || *name == "CRS:84") {
        cannot(fmt::format("{} needs no grid of its own: its maps are derived from {}", *name,
                           kBuiltCrs));
        continue;
      }
      try {
        find_target_grid(*name);
      } catch (const std::exception& error) {
        cannot(error.what());
      }
    }
    if (layer.crs.size() == 1) return;
    if (!layer.live_query.empty()) cannot("a layer with a live_query is built for one system only");
    if (layer.close_gaps.value_or(0) > 0) cannot("gaps are closed for one system only");
  }

  void keep(LayerConfig layer, const toml::source_position& position) {
    const auto [first, is_new] = lines_.emplace(layer.name, position.line);
    if (!is_new && !layer.name.empty()) {
      fail(position, fmt::format("layer \"{}\" is defined twice, first in line {}", layer.name,
                                 first->second));
    }
    loaded_.config.layers.push_back(std::move(layer));
  }

  /// The value as written in a query; nothing if a query cannot contain it.
  std::optional<std::string> query_text_of(const toml::node& node) {
    if (node.is_string()) return expanded(node);
    if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
    if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
    const toml::array* list = node.as_array();
    if (list == nullptr) return std::nullopt;
    std::string joined;
    for (const toml::node& item : *list) {
      const auto text = item.is_array() ? std::nullopt : query_text_of(item);
      if (!text) return std::nullopt;
      if (!joined.empty()) joined.push_back(',');
      joined += *text;
    }
    return joined;
  }

  /// Reads style parameters, in whose names '_' may replace '-', as query pairs. Tables, if they
  /// are allowed, contain the parameters of one layer each.
  void read_style_pairs(const toml::table& table, const std::string& layer, bool has_layers,
                        std::vector<QueryPair>& pairs) {
    for (const auto& [key, node] : table) {
      if (has_layers && node.is_table()) {
        if (!is_url_name(key.str())) {
          fail(key.source().begin, fmt::format("\"{}\" cannot name a layer", key.str()));
          continue;
        }
        read_style_pairs(*node.as_table(), std::string(key.str()), false, pairs);
      } else if (auto pair = read_style_pair(key, node, layer, has_layers)) {
        pairs.push_back(std::move(*pair));
      }
    }
  }

  std::optional<QueryPair> read_style_pair(const toml::key& key, const toml::node& node,
                                           const std::string& layer, bool has_layers) {
    std::string name(key.str());
    std::ranges::replace(name, '_', '-');
    const StyleParameter* parameter = find_style_parameter(name);
    const bool is_for_all_layers = layer.empty() && has_layers;
    if (parameter == nullptr || parameter->id == ParameterId::style ||
        (!parameter->is_per_layer && !is_for_all_layers)) {
      std::vector<std::string> known;
      for (const StyleParameter& each : style_parameters()) known.emplace_back(each.name);
      fail(key.source().begin,
           parameter == nullptr
               ? fmt::format("a style does not know \"{}\"{}", key.str(), did_you_mean(name, known))
           : parameter->id == ParameterId::style
               ? "a style cannot name another one"
               : fmt::format("\"{}\" is for all layers, so it cannot be in the style of one",
                             key.str()));
      return std::nullopt;
    }
    const auto text = query_text_of(node);
    const QueryPair pair(layer.empty() ? name : layer + "." + name, text.value_or(""));
    if (text && make_style({pair}, layer.empty() ? Names() : Names{layer})) return pair;
    fail(node, fmt::format("{} takes {}", key.str(), describe_values(*parameter)));
    return std::nullopt;
  }

  using Names = std::vector<std::string>;

  static std::optional<StyleQuery> make_style(const std::vector<QueryPair>& pairs,
                                              const Names& layers) {
    auto style = StyleQuery::parse(pairs, layers);
    if (!style) return std::nullopt;
    return *std::move(style);
  }

  StyleQuery read_layer_style(const toml::node& node) {
    std::vector<QueryPair> pairs;
    if (const toml::table* table = node.as_table()) {
      read_style_pairs(*table, {}, false, pairs);
    } else {
      fail(node, "layer.style takes a table");
    }
    return style_or_problem(node, pairs, {});
  }

  /// Combines pairs that have been checked individually.
  StyleQuery style_or_problem(const toml::node& node, const std::vector<QueryPair>& pairs,
                              const Names& layers) {
    auto style = StyleQuery::parse(pairs, layers);
    if (!style) {
      fail(node, style.problem().detail);  // set twice, as fill_opacity and fill-opacity
      return {};
    }
    return *std::move(style);
  }

  void read_styles(const toml::node& node) {
    const toml::table* table = node.as_table();
    if (table == nullptr) return fail(node, "styles are tables, begun by [styles.NAME]");
    for (const auto& [key, style] : *table) read_named_style(std::string(key.str()), style);
  }

  void read_fonts(const toml::node& node) {
    const toml::table* tables = node.as_table();
    if (tables == nullptr) return fail(node, "fonts are tables, begun by [fonts.NAME]");
    for (const auto& [key, table] : *tables) {
      const std::string name(key.str());
      if (!is_url_name(name) || !table.is_table()) {
        fail(table,
             "fonts are tables, each begun by [fonts.NAME] with a name of 1 to 64 letters, digits, "
             "'_' or '-'");
        continue;
      }
      FontsConfig read;
      const std::size_t before = loaded_.problems.size();
      read_settings(*table.as_table(), fonts_settings(), read, "fonts." + name);
      if (loaded_.problems.size() == before && read.files.empty()) {
        fail(table, fmt::format("fonts \"{}\" need files", name));
      }
      loaded_.config.fonts.emplace(name, std::move(read));
    }
  }

  void read_value_tables(const toml::node& node) {
    const toml::table* tables = node.as_table();
    if (tables == nullptr) return fail(node, "tables of values are begun by [values.NAME]");
    for (const auto& [key, table] : *tables) {
      const std::string name(key.str());
      if (!is_url_name(name) || !table.is_table()) {
        fail(table,
             "tables of values are each begun by [values.NAME] with a name of 1 to 64 letters, "
             "digits, '_' or '-'");
        continue;
      }
      ValueTableConfig read;
      const std::size_t before = loaded_.problems.size();
      read_settings(*table.as_table(), value_table_settings(), read, "values." + name);
      if (loaded_.problems.size() == before && read.file.empty()) {
        fail(table, fmt::format("values \"{}\" need a file", name));
      }
      loaded_.config.values.emplace(name, std::move(read));
    }
  }

  void read_named_style(const std::string& name, const toml::node& node) {
    const toml::table* table = node.as_table();
    if (!is_url_name(name) || name == StyleBook::kDefaultName || table == nullptr) {
      return fail(node, fmt::format("styles are tables, each begun by [styles.NAME] with a name of "
                                    "1 to 64 letters, digits, '_' or '-' other than \"{}\"",
                                    StyleBook::kDefaultName));
    }
    std::vector<QueryPair> pairs;
    read_style_pairs(*table, {}, true, pairs);
    Names layers;
    for (const auto& [layer, style] : *table) {
      if (style.is_table()) layers.emplace_back(layer.str());
    }
    loaded_.config.styles.emplace(name, style_or_problem(node, pairs, layers));
    keep_origin("styles." + name, node);
  }

  const std::string& path_;
  LoadedConfig& loaded_;
  std::vector<toml::source_position> positions_;               // of the problems
  std::unordered_map<std::string, toml::source_index> lines_;  // of layers, by name
};

/// `parse` returns the table of the file at `path`.
template <typename Parse>
void read_toml(const std::string& path, Parse parse, LoadedConfig& loaded) {
  try {
    const toml::table root = parse();
    ConfigReader(path, loaded).read(root);
  } catch (const toml::parse_error& error) {
    // Position 0:0 means that the file could not be opened; its text is not at fault.
    const auto position = error.source().begin;
    const std::string what(error.description());
    loaded.problems.push_back(position.line == 0
                                  ? ConfigProblem{path, "cannot read the configuration: " + what}
                                  : ConfigProblem{position_text(path, position), what});
  }
}

template <typename Number>
std::optional<SettingValue> number_in(const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::vector<std::string> words_in(std::string_view text) {
  std::vector<std::string> words;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    words.emplace_back(text.substr(0, comma));
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return words;
}

/// The value that a text represents for a setting of that type; nothing if it is invalid.
std::optional<SettingValue> value_in(SettingType type, const std::string& text) {
  switch (type) {
    case SettingType::boolean:
      if (text != "true" && text != "false") return std::nullopt;
      return text == "true";
    case SettingType::integer:
      return number_in<std::int64_t>(text);
    case SettingType::number:
      return number_in<double>(text);
    case SettingType::text:
    case SettingType::amount:
    case SettingType::path:
      return text;
    case SettingType::list:
    case SettingType::paths:
      return words_in(text);
  }
  return std::nullopt;
}

std::string variable_of(const Setting<Config>& setting) {
  std::string name = fmt::format("{}{}_{}", kVariablePrefix, setting.table, setting.key);
  std::ranges::transform(name, name.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return name;
}

/// Whether Kubernetes sets the variable in every container for a service with a name like
/// trapeze-server or trapeze-admin: TRAPEZE_SERVER_SERVICE_HOST, TRAPEZE_SERVER_PORT_8080_TCP, and
/// TRAPEZE_SERVER_PORT, which has the name of a setting, with a URL such as tcp://10.0.0.1:80.
bool is_service_link(std::string_view variable, std::string_view value) {
  constexpr std::string_view kPort = "_PORT_";
  const std::size_t port = variable.find(kPort);
  const std::string_view number =
      port == std::string_view::npos ? "" : variable.substr(port + kPort.size());
  return variable.find("_SERVICE_HOST") != std::string_view::npos ||
         variable.find("_SERVICE_PORT") != std::string_view::npos ||
         (variable.ends_with("_PORT") && value.find("://") != std::string_view::npos) ||
         (!number.empty() && number.front() >= '0' && number.front() <= '9');
}

/// Whether it begins like variables of settings: TRAPEZE_SERVER_PROT does, TRAPEZE_DATA does not.
bool is_of_a_table(std::string_view variable) {
  return std::ranges::any_of(config_settings(), [variable](const Setting<Config>& setting) {
    const std::string of_setting = variable_of(setting);
    const std::size_t beginning = kVariablePrefix.size() + setting.table.size() + 1;
    return variable.starts_with(std::string_view(of_setting).substr(0, beginning));
  });
}

ConfigProblem unknown_variable(const std::string& variable) {
  std::vector<std::string> known;
  for (const auto& setting : config_settings()) known.push_back(variable_of(setting));
  return {variable, "there is no such setting; `trapeze config print` shows all" +
                        did_you_mean(variable, known)};
}

void apply(const ConfigOverride& change, LoadedConfig& loaded) {
  const auto found = std::ranges::find(config_settings(), change.setting, &Setting<Config>::name);
  if (found == config_settings().end()) {
    loaded.problems.push_back(unknown_variable(change.origin));
    return;
  }
  const auto& setting = *found;
  const auto value = value_in(setting.type, change.value);
  if (value && assign(setting, loaded.config, *value)) {
    // The items of a list in the file are replaced, too.
    std::erase_if(loaded.origins, [&change](const auto& origin) {
      return origin.first.starts_with(change.setting + '[');
    });
    loaded.origins[change.setting] = change.origin;
    return;
  }
  const bool is_list = setting.type == SettingType::list || setting.type == SettingType::paths;
  loaded.problems.push_back(
      {change.origin,
       fmt::format("takes {}{}{}", setting.takes, is_list ? ", with commas between them" : "",
                   is_list ? "" : did_you_mean(change.value, setting.choices))});
}

/// The title of a layer for people, from the name of its file.
std::string layer_title_of_file(const std::string& file) {
  std::filesystem::path path(file);
  if (!path.has_filename()) path = path.parent_path();  // a folder written with a trailing '/'
  std::string name = path.stem().string();
  // For a pattern, the text before the wildcard, or else the folder.
  if (const std::size_t wild = name.find_first_of("*?"); wild != std::string::npos) {
    name = name.substr(0, wild);
    while (!name.empty() && std::string_view("-_.").find(name.back()) != std::string_view::npos) {
      name.pop_back();
    }
    if (name.empty()) name = path.parent_path().filename().string();
  }
  return name;
}

/// The same in a form that is valid in URLs.
std::string url_name_of(std::string name) {
  name = name.substr(0, kMaxUrlNameLength);
  for (char& c : name) {
    if (!is_url_name(std::string_view(&c, 1))) c = '_';
  }
  return name.empty() ? "layer" : name;
}

}  // namespace

std::string LoadedConfig::origin_of(const std::string& setting,
                                    std::optional<std::size_t> item) const {
  const auto of_item = item ? origins.find(name_of_item(setting, *item)) : origins.end();
  if (of_item != origins.end()) return of_item->second;
  const auto found = origins.find(setting);
  return found == origins.end() ? "default" : found->second;
}

bool is_file_path(const std::string& source) {
  const std::size_t colon = source.find(':');
  return !source.empty() && !source.starts_with("/vsi") &&
         (colon == std::string::npos || source.find('/') < colon);
}

LoadedConfig load_config(const std::string& path, const std::vector<ConfigOverride>& overrides) {
  LoadedConfig loaded;
  std::error_code error;  // then it is told when the file is opened
  if (std::filesystem::is_directory(path, error)) {
    loaded.problems.push_back({path, "cannot read the configuration: it is a folder"});
  } else if (!path.empty()) {
    read_toml(
        path, [&path] { return toml::parse_file(path); }, loaded);
  }
  for (const ConfigOverride& change : overrides) apply(change, loaded);
  return loaded;
}

LoadedConfig load_config_text(std::string_view text, const std::string& path) {
  LoadedConfig loaded;
  read_toml(
      path, [text] { return toml::parse(text); }, loaded);
  return loaded;
}

std::vector<ConfigOverride> environment_overrides(const char* const* environment) {
  std::vector<ConfigOverride> overrides;
  for (; *environment != nullptr; ++environment) {
    const std::string_view entry = *environment;
    const std::size_t equals = entry.find('=');
    if (!entry.starts_with(kVariablePrefix) || equals == std::string_view::npos) continue;
    const std::string name(entry.substr(0, equals));
    const std::string value(entry.substr(equals + 1));
    const auto setting = std::ranges::find(config_settings(), name, variable_of);
    const bool is_setting = setting != config_settings().end();
    // Other programs may have variables of their own.
    if (is_service_link(name, value) || (!is_setting && !is_of_a_table(name))) continue;
    overrides.push_back({is_setting ? setting->name() : "", value, name});
  }
  return overrides;
}

Config read_config(const std::string& path) {
  LoadedConfig loaded = load_config(path, {});
  if (!loaded.problems.empty()) throw std::runtime_error(problems_text(loaded.problems));
  return std::move(loaded.config);
}

std::string problems_text(const std::vector<ConfigProblem>& problems) {
  std::string text;
  for (const ConfigProblem& problem : problems) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : "\n", problem.where, problem.what);
  }
  return text;
}

std::vector<LayerConfig> layers_of_files(const std::vector<std::string>& files) {
  std::vector<LayerConfig> layers;
  for (const std::string& file : files) {
    LayerConfig layer;
    const std::string title = layer_title_of_file(file);
    layer.name = url_name_of(title);
    layer.title = title.empty() ? layer.name : title;
    layer.file = file;
    const auto same = std::ranges::find(layers, layer.name, &LayerConfig::name);
    if (same != layers.end()) {
      throw std::runtime_error(
          fmt::format("{} and {} would both be the layer \"{}\"; rename one, or name them in a "
                      "configuration",
                      same->file, file, layer.name));
    }
    layers.push_back(std::move(layer));
  }
  return layers;
}

}  // namespace trapeze
