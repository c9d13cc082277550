#include "server/config.h"

#include <spdlog/fmt/fmt.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "server/style_book.h"
#include "server/style_parameters.h"
#include "server/tile_request.h"
#include "server/url.h"

namespace trapeze {
namespace {

constexpr std::string_view kLayerNameRule = "1 to 64 letters, digits, '_' or '-'";

std::string position_text(const std::string& path, const toml::source_position& position) {
  return fmt::format("{}:{}:{}", path, position.line, position.column);
}

/// Reads the keys of one table one by one; whatever has not been asked for at the end is unknown.
class TableReader {
 public:
  /// `name` is how messages call the table: "server" for [server].
  TableReader(const std::string& path, const toml::table& table, std::string name)
      : path_(path), table_(table), name_(std::move(name)) {}

  [[noreturn]] void fail(const toml::node& node, const std::string& message) const {
    throw std::runtime_error(
        fmt::format("{}: {}", position_text(path_, node.source().begin), message));
  }
  [[noreturn]] void fail(const std::string& message) const { fail(table_, message); }
  [[noreturn]] void fail(const toml::key& key, const std::string& message) const {
    throw std::runtime_error(
        fmt::format("{}: {}", position_text(path_, key.source().begin), message));
  }

  const toml::node* find(std::string_view key) {
    known_.emplace_back(key);
    return table_.get(key);
  }

  std::string full_name(std::string_view key) const {
    return name_.empty() ? std::string(key) : fmt::format("{}.{}", name_, key);
  }

  void read(std::string_view key, std::string& target) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    if (!node->is_string()) fail(*node, fmt::format("{} takes a string", full_name(key)));
    target = node->as_string()->get();
  }

  void read(std::string_view key, std::vector<std::string>& target) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    if (array == nullptr) fail(*node, fmt::format("{} takes a list of strings", full_name(key)));
    for (const toml::node& item : *array) {
      if (!item.is_string()) fail(item, fmt::format("{} takes a list of strings", full_name(key)));
      target.push_back(item.as_string()->get());
    }
  }

  template <typename Integer>
  void read(std::string_view key, Integer& target, std::int64_t min, std::int64_t max) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto value = node->is_integer() ? node->value<std::int64_t>() : std::nullopt;
    if (!value || *value < min || *value > max) {
      fail(*node, fmt::format("{} takes an integer from {} to {}", full_name(key), min, max));
    }
    target = static_cast<Integer>(*value);
  }

  /// Call last: throws if the table holds a key that was never asked for.
  void refuse_unknown_keys() const {
    for (const auto& [key, node] : table_) {
      if (std::ranges::find(known_, key.str()) != known_.end()) continue;
      throw std::runtime_error(fmt::format("{}: unknown key {}; allowed here are {}",
                                           position_text(path_, key.source().begin),
                                           full_name(key.str()), fmt::join(known_, ", ")));
    }
  }

 private:
  const std::string& path_;
  const toml::table& table_;
  std::string name_;
  std::vector<std::string> known_;
};

std::string relative_to_config(const std::string& config_path, const std::string& path) {
  if (path.empty()) return path;
  return (std::filesystem::path(config_path).parent_path() / path).lexically_normal().string();
}

ServerConfig read_server(const std::string& path, const toml::table& table) {
  ServerConfig server;
  TableReader reader(path, table, "server");
  reader.read("address", server.address);
  reader.read("port", server.port, 0, 65535);
  reader.read("threads", server.threads, 1, 256);
  reader.read("workers", server.workers, 0, 256);
  reader.read("queue", server.queue, 1, 1'000'000);
  reader.read("deadline_ms", server.deadline_ms, 1, 600'000);
  reader.read("batch", server.batch, 1, 64);
  reader.read("posted_styles_mb", server.posted_styles_mb, 0, 4096);
  reader.read("cache_mb", server.cache_mb, 0, 1'000'000);
  reader.read("cache_control", server.cache_control);
  if (std::ranges::any_of(server.cache_control, [](char c) { return c < ' ' || c > '~'; })) {
    reader.fail(*table.get("cache_control"),
                "server.cache_control takes the value of a Cache-Control header");
  }
  std::string renderer = "auto";
  reader.read("renderer", renderer);
  if (const auto kind = renderer_kind_from(renderer)) {
    server.renderer.kind = *kind;
  } else {
    reader.fail(*table.get("renderer"),
                "server.renderer takes \"auto\", \"egl\", \"osmesa\" or \"software\"");
  }
  reader.read("device", server.renderer.device);
  reader.read("public_url", server.public_url);
  while (server.public_url.ends_with('/')) server.public_url.pop_back();
  if (!server.public_url.empty() && !server.public_url.starts_with("http://") &&
      !server.public_url.starts_with("https://")) {
    reader.fail(*table.get("public_url"),
                "server.public_url takes a URL that begins with http:// or https://");
  }
  reader.read("allowed_hosts", server.allowed_hosts);
  for (const std::string& host : server.allowed_hosts) {
    if (!is_valid_host(std::string_view(host).substr(host.starts_with("*.") ? 2 : 0))) {
      reader.fail(*table.get("allowed_hosts"),
                  fmt::format("server.allowed_hosts takes names of hosts, with or without a port, "
                              "\"*.\" before them for all below; \"{}\" is none",
                              host));
    }
  }
  reader.read("web_root", server.web_root);
  server.web_root = relative_to_config(path, server.web_root);
  reader.refuse_unknown_keys();
  return server;
}

/// As the value is written in a query; nothing for what has no place there.
std::optional<std::string> text_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  const toml::array* list = node.as_array();
  if (list == nullptr) return std::nullopt;
  std::string joined;
  for (const toml::node& item : *list) {
    const auto text = item.is_array() ? std::nullopt : text_of(item);
    if (!text) return std::nullopt;
    if (!joined.empty()) joined.push_back(',');
    joined += *text;
  }
  return joined;
}

/// Style parameters by their names, in which '_' may stand for '-', as pairs of a query. Tables are
/// for one layer each, if they are allowed.
void read_style_pairs(const TableReader& reader, const toml::table& table, const std::string& layer,
                      bool has_layers, std::vector<QueryPair>& pairs) {
  const std::vector<std::string> layers =
      layer.empty() ? std::vector<std::string>() : std::vector<std::string>{layer};
  for (const auto& [key, node] : table) {
    if (has_layers && node.is_table()) {
      read_style_pairs(reader, *node.as_table(), std::string(key.str()), false, pairs);
      continue;
    }
    std::string name(key.str());
    std::ranges::replace(name, '_', '-');
    const StyleParameter* parameter = find_style_parameter(name);
    const bool is_for_all_layers = layer.empty() && has_layers;
    if (parameter == nullptr || parameter->id == ParameterId::style ||
        (!parameter->is_per_layer && !is_for_all_layers)) {
      reader.fail(key, fmt::format("a style does not know \"{}\"", std::string(key.str())));
    }
    const auto text = text_of(node);
    const std::string written = layer.empty() ? name : layer + "." + name;
    const QueryPair pair(written, text.value_or(""));
    if (!text || !std::holds_alternative<StyleQuery>(StyleQuery::parse({&pair, 1}, layers))) {
      reader.fail(node,
                  fmt::format("{} takes {}", std::string(key.str()), describe_values(*parameter)));
    }
    pairs.push_back(pair);
  }
}

StyleQuery read_layer_style(const std::string& path, const toml::table& table) {
  const TableReader reader(path, table, "layer.style");
  std::vector<QueryPair> pairs;
  read_style_pairs(reader, table, {}, false, pairs);
  return std::get<StyleQuery>(StyleQuery::parse(pairs, {}));
}

/// [styles.NAME]
std::map<std::string, StyleQuery> read_styles(const std::string& path, const toml::table& table) {
  const TableReader reader(path, table, "styles");
  std::map<std::string, StyleQuery> styles;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (!is_style_name(name) || name == StyleBook::kDefaultName || !node.is_table()) {
      reader.fail(node, fmt::format("styles are tables, each begun by [styles.NAME] with a name "
                                    "of 1 to 64 letters, digits, '_' or '-' other than \"{}\"",
                                    StyleBook::kDefaultName));
    }
    std::vector<QueryPair> pairs;
    read_style_pairs(reader, *node.as_table(), {}, true, pairs);
    std::vector<std::string> layers;
    for (const auto& [layer, style] : *node.as_table()) {
      if (style.is_table()) layers.emplace_back(layer.str());
    }
    styles.emplace(name, std::get<StyleQuery>(StyleQuery::parse(pairs, layers)));
  }
  return styles;
}

std::vector<ParameterId> read_locked(TableReader& reader) {
  std::vector<std::string> names;
  reader.read("locked", names);
  std::vector<ParameterId> locked;
  for (const std::string& name : names) {
    const StyleParameter* parameter = find_style_parameter(name);
    if (parameter == nullptr || !parameter->is_per_layer) {
      std::vector<std::string_view> known;
      for (const StyleParameter& p : style_parameters()) {
        if (p.is_per_layer) known.push_back(p.name);
      }
      reader.fail(*reader.find("locked"),
                  fmt::format("layer.locked takes names of parameters that are set for one layer, "
                              "and \"{}\" is none; known are {}",
                              name, fmt::join(known, ", ")));
    }
    locked.push_back(parameter->id);
  }
  return locked;
}

LayerConfig read_layer(const std::string& path, const toml::table& table) {
  LayerConfig layer;
  TableReader reader(path, table, "layer");
  reader.read("name", layer.name);
  if (!is_layer_name(layer.name)) {
    const toml::node* node = table.get("name");
    reader.fail(node == nullptr ? static_cast<const toml::node&>(table) : *node,
                fmt::format("every [[layer]] needs a name of {}", kLayerNameRule));
  }
  reader.read("file", layer.file);
  reader.read("prepared", layer.prepared);
  if (layer.file_to_open().empty()) {
    reader.fail(fmt::format("layer \"{}\" needs a file", layer.name));
  }
  layer.file = relative_to_config(path, layer.file);
  layer.prepared = relative_to_config(path, layer.prepared);
  layer.title = layer.name;
  reader.read("title", layer.title);
  reader.read("attribution", layer.attribution);
  reader.read("description", layer.description);
  reader.read("min_zoom", layer.min_zoom, 0, kMaxZoom);
  reader.read("max_zoom", layer.max_zoom, 0, kMaxZoom);
  if (layer.min_zoom > layer.max_zoom) {
    reader.fail(fmt::format("layer \"{}\" has a min_zoom above its max_zoom", layer.name));
  }
  std::string weights;
  reader.read("weights", weights);
  if (const toml::node* node = table.get("weights")) {
    layer.weights = weight_rule_from_name(weights);
    if (!layer.weights) {
      reader.fail(
          *node,
          "layer.weights takes \"douglas-peucker\", \"raised-parents\" or \"effective-area\"");
    }
  }
  if (const toml::node* style = reader.find("style")) {
    if (!style->is_table()) reader.fail(*style, "layer.style takes a table");
    layer.style = read_layer_style(path, *style->as_table());
  }
  layer.locked = read_locked(reader);
  reader.refuse_unknown_keys();
  return layer;
}

void read_layers(const std::string& path, const toml::node& node,
                 std::vector<LayerConfig>& layers) {
  const toml::array* array = node.as_array();
  std::unordered_map<std::string, toml::source_position> seen;
  for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
    const toml::table* table = array->get_as<toml::table>(i);
    if (table == nullptr) break;
    layers.push_back(read_layer(path, *table));
    const auto [first, is_new] = seen.emplace(layers.back().name, table->source().begin);
    if (!is_new) {
      throw std::runtime_error(fmt::format("{}: layer \"{}\" is defined twice, first in line {}",
                                           position_text(path, table->source().begin),
                                           layers.back().name, first->second.line));
    }
  }
  if (array == nullptr || layers.size() != array->size()) {
    throw std::runtime_error(fmt::format("{}: layers are tables, each begun by [[layer]]",
                                         position_text(path, node.source().begin)));
  }
}

toml::table parse_toml(const std::string& path) {
  try {
    return toml::parse_file(path);
  } catch (const toml::parse_error& error) {
    // Position 0:0 means that the file could not be opened, not that its text is wrong.
    if (error.source().begin.line == 0) {
      throw std::runtime_error(
          fmt::format("cannot read the configuration {}: {}", path, error.description()));
    }
    throw std::runtime_error(
        fmt::format("{}: {}", position_text(path, error.source().begin), error.description()));
  }
}

std::string layer_name_of_file(const std::string& file) {
  std::filesystem::path path(file);
  if (!path.has_filename()) path = path.parent_path();  // a folder written with a '/' at the end
  std::string name = path.stem().string().substr(0, kMaxLayerNameLength);
  for (char& c : name) {
    if (!is_layer_name(std::string_view(&c, 1))) c = '_';
  }
  return name.empty() ? "layer" : name;
}

}  // namespace

Config read_config(const std::string& path) {
  const toml::table root = parse_toml(path);
  Config config;
  TableReader reader(path, root, "");
  if (const toml::node* server = reader.find("server")) {
    if (!server->is_table()) reader.fail(*server, "server takes a table, begun by [server]");
    config.server = read_server(path, *server->as_table());
  }
  if (const toml::node* styles = reader.find("styles")) {
    if (!styles->is_table()) reader.fail(*styles, "styles are tables, begun by [styles.NAME]");
    config.styles = read_styles(path, *styles->as_table());
  }
  if (const toml::node* layers = reader.find("layer")) read_layers(path, *layers, config.layers);
  reader.refuse_unknown_keys();
  return config;
}

std::vector<LayerConfig> layers_of_files(const std::vector<std::string>& files) {
  std::vector<LayerConfig> layers;
  for (const std::string& file : files) {
    LayerConfig layer;
    layer.name = layer_name_of_file(file);
    layer.title = layer.name;
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
