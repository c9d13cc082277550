#include "server/config/config_settings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/borders/gap_closing.h"
#include "core/graph/topology.h"
#include "core/layer/layer_options.h"
#include "server/base/language_tag.h"
#include "server/base/url.h"
#include "server/base/zoom_range.h"
#include "server/styles/style_parameters.h"

namespace trapeze {

bool LayerConfig::has_fast_topology() const {
  const ParameterValue* topology = style.find({}, ParameterId::topology);
  return fast_topology ||
         (topology != nullptr &&
          *topology == ParameterValue(std::string(kTopologyNames.name_of(Topology::fast))));
}

namespace {

constexpr int kMaxMilliseconds = 600'000;

// In all functions below that make settings, `place` returns a reference to the value in its owner;
// it is const if the owner is.

template <typename Owner>
// NOLINTNEXTLINE(performance-unnecessary-value-param): both are moved from
Setting<Owner> begin(std::string_view name, SettingType type, std::string takes, std::string help) {
  const std::size_t dot = name.find('.');
  Setting<Owner> setting;
  setting.table = dot == std::string_view::npos ? "" : name.substr(0, dot);
  setting.key = dot == std::string_view::npos ? name : name.substr(dot + 1);
  setting.type = type;
  setting.takes = std::move(takes);
  setting.help = std::move(help);
  return setting;
}

template <typename Owner, typename Place>
Setting<Owner> integer(std::string_view name, Place place, std::int64_t min, std::int64_t max,
                       std::string help) {
  auto setting = begin<Owner>(name, SettingType::integer,
                              fmt::format("an integer from {} to {}", min, max), std::move(help));
  setting.min = static_cast<double>(min);
  setting.max = static_cast<double>(max);
  setting.get = [place](const Owner& owner) -> SettingValue {
    return static_cast<std::int64_t>(place(owner));
  };
  setting.set = [place](Owner& owner, const SettingValue& value) {
    auto& target = place(owner);
    target = static_cast<std::remove_reference_t<decltype(target)>>(std::get<std::int64_t>(value));
    return true;
  };
  return setting;
}

/// A value that is stored as it is written.
template <typename Value, typename Owner, typename Place>
Setting<Owner> plain(Setting<Owner> setting, Place place) {
  setting.get = [place](const Owner& owner) -> SettingValue { return place(owner); };
  setting.set = [place](Owner& owner, const SettingValue& value) {
    place(owner) = std::get<Value>(value);
    return true;
  };
  return setting;
}

template <typename Owner, typename Place>
Setting<Owner> number(std::string_view name, Place place, double min, double max,
                      std::string help) {
  auto setting = begin<Owner>(name, SettingType::number,
                              fmt::format("a number from {} to {}", min, max), std::move(help));
  setting.min = min;
  setting.max = max;
  return plain<double>(std::move(setting), place);
}

template <typename Owner, typename Place>
Setting<Owner> boolean(std::string_view name, Place place, std::string help) {
  return plain<bool>(begin<Owner>(name, SettingType::boolean, "true or false", std::move(help)),
                     place);
}

template <typename Owner, typename Place>
Setting<Owner> text(std::string_view name, Place place, std::string help) {
  return plain<std::string>(begin<Owner>(name, SettingType::text, "a string", std::move(help)),
                            place);
}

template <typename Owner, typename Place>
Setting<Owner> path(std::string_view name, Place place, std::string help) {
  return plain<std::string>(begin<Owner>(name, SettingType::path, "a string", std::move(help)),
                            place);
}

/// Text that is converted: `parse` returns nothing for invalid text.
template <typename Owner, typename Place, typename Parse, typename ToText>
Setting<Owner> parsed(std::string_view name, Place place, std::string takes, Parse parse,
                      ToText to_words, std::string help) {
  auto setting = begin<Owner>(name, SettingType::text, std::move(takes), std::move(help));
  setting.get = [place, to_words](const Owner& owner) -> SettingValue {
    return std::string(to_words(place(owner)));
  };
  setting.set = [place, parse](Owner& owner, const SettingValue& value) {
    auto made = parse(std::get<std::string>(value));
    if (!made) return false;
    place(owner) = std::move(*made);
    return true;
  };
  return setting;
}

template <typename Value>
using Words = std::vector<std::pair<std::string, Value>>;

/// One of a few words.
template <typename Value, typename Owner, typename Place>
Setting<Owner> choice(std::string_view name, Place place, const Words<Value>& words,
                      std::string help) {
  std::string takes;
  std::vector<std::string> choices;
  for (const auto& [word, value] : words) {
    takes += takes.empty() ? "" : &word == &words.back().first ? " or " : ", ";
    takes += '"' + word + '"';
    choices.push_back(word);
  }
  auto setting = parsed<Owner>(
      name, place, std::move(takes),
      [words](const std::string& text) -> std::optional<Value> {
        for (const auto& [word, value] : words) {
          if (word == text) return value;
        }
        return std::nullopt;
      },
      [words](const Value& wanted) {
        return std::ranges::find(words, wanted, &std::pair<std::string, Value>::second)->first;
      },
      std::move(help));
  setting.choices = std::move(choices);
  return setting;
}

/// A list of strings, each of which `parse` accepts.
template <typename Owner, typename Place, typename Parse, typename ToText>
Setting<Owner> list(std::string_view name, Place place, std::string takes, Parse parse,
                    ToText to_words, std::string help) {
  auto setting = begin<Owner>(name, SettingType::list, std::move(takes), std::move(help));
  setting.get = [place, to_words](const Owner& owner) -> SettingValue {
    std::vector<std::string> items;
    for (const auto& item : place(owner)) items.push_back(to_words(item));
    return items;
  };
  setting.set = [place, parse](Owner& owner, const SettingValue& value) {
    std::remove_reference_t<decltype(place(owner))> made;
    for (const std::string& item : std::get<std::vector<std::string>>(value)) {
      auto parsed_item = parse(item);
      if (!parsed_item) return false;
      made.push_back(std::move(*parsed_item));
    }
    place(owner) = std::move(made);
    return true;
  };
  return setting;
}

std::string same(const std::string& text) {
  return text;
}

std::optional<std::string> header_value(const std::string& text) {
  if (std::ranges::any_of(text, [](char c) { return c < ' ' || c > '~'; })) return std::nullopt;
  return text;
}

std::optional<std::string> public_url(std::string url) {
  while (url.ends_with('/')) url.pop_back();
  if (!std::ranges::all_of(url, [](char c) { return c > ' ' && c <= '~'; })) return std::nullopt;
  if (url.empty() || url.starts_with("http://") || url.starts_with("https://")) return url;
  return std::nullopt;
}

std::optional<std::string> host_pattern(const std::string& host) {
  if (!is_valid_host(std::string_view(host).substr(host.starts_with("*.") ? 2 : 0))) {
    return std::nullopt;
  }
  return host;
}

std::optional<std::string> listen_address(const std::string& text) {
  if (!parse_address(text)) return std::nullopt;
  return text;
}

/// With or without its '#'.
std::optional<std::string> start_of_viewer(const std::string& text) {
  if (std::ranges::any_of(text, [](char c) { return c >= 0 && c < ' '; })) return std::nullopt;
  return text.starts_with('#') ? text.substr(1) : text;
}

std::string range_text(const AddressRange& range) {
  const bool is_ipv4 = range.first.is_ipv4() && range.bits >= 96;
  return fmt::format("{}/{}", address_text(range.first), is_ipv4 ? range.bits - 96 : range.bits);
}

/// The names used for the values everywhere.
template <typename Value, typename Names>
Words<Value> words_of(const Names& names) {
  Words<Value> words;
  for (const std::string_view name : names.names()) words.emplace_back(name, *names.find(name));
  return words;
}

const Words<RendererKind>& renderer_words() {
  static const auto words = words_of<RendererKind>(kRendererNames);
  return words;
}

const Words<std::string>& level_words() {
  static const Words<std::string> words = {
      {"trace", "trace"}, {"debug", "debug"},       {"info", "info"}, {"warning", "warning"},
      {"error", "error"}, {"critical", "critical"}, {"off", "off"}};
  return words;
}

const Words<LogFormat>& format_words() {
  static const Words<LogFormat> words = {{"text", LogFormat::text}, {"json", LogFormat::json}};
  return words;
}

const Words<std::optional<WeightRule>>& weight_words() {
  static const auto words = words_of<std::optional<WeightRule>>(kWeightNames);
  return words;
}

const Words<std::optional<CoverageMode>>& coverage_words() {
  static const auto words = words_of<std::optional<CoverageMode>>(kCoverageNames);
  return words;
}

/// There is no word for "not set".
Setting<LayerConfig> weights_setting() {
  auto setting = choice<std::optional<WeightRule>, LayerConfig>(
      "weights", [](auto& layer) -> auto& { return layer.weights; }, weight_words(),
      "what makes a vertex matter; not set: as a file was prepared, else \"" +
          std::string(kWeightNames.name_of(WeightRule::douglas_peucker)) + "\"");
  setting.get = [words = setting.get](const LayerConfig& layer) -> SettingValue {
    return layer.weights ? words(layer) : SettingValue(std::string());
  };
  return setting;
}

/// There is no word for "not set".
Setting<LayerConfig> coverage_setting() {
  auto setting = choice<std::optional<CoverageMode>, LayerConfig>(
      "coverage", [](auto& layer) -> auto& { return layer.coverage; }, coverage_words(),
      "whether polygons that share borders keep them in common: \"auto\", where two have an edge "
      "in common and do not overlap by more than 1 %; \"on\", all that lie near each other, "
      "however much they overlap; \"off\", each by itself; not set: as a file was "
      "prepared, else \"" +
          std::string(kCoverageNames.name_of(kUsualCoverage)) + "\"");
  setting.get = [words = setting.get](const LayerConfig& layer) -> SettingValue {
    return layer.coverage ? words(layer) : SettingValue(std::string());
  };
  return setting;
}

/// There is no number for "not set".
Setting<LayerConfig> close_gaps_setting() {
  auto setting = begin<LayerConfig>(
      "close_gaps", SettingType::number, fmt::format("a number from 0 to {}", kWidestGap),
      "metres on the ground up to which gaps and overlaps between polygons are closed where "
      "coverage is \"auto\" or \"on\"; not set: as a file was prepared, else 0");
  setting.min = 0;
  setting.max = kWidestGap;
  setting.get = [](const LayerConfig& layer) -> SettingValue {
    if (!layer.close_gaps) return std::string();
    return *layer.close_gaps;
  };
  setting.set = [](LayerConfig& layer, const SettingValue& value) {
    layer.close_gaps = std::get<double>(value);
    return true;
  };
  return setting;
}

/// There is no number for "not set".
Setting<LayerConfig> merge_setting() {
  auto setting = begin<LayerConfig>(
      "merge", SettingType::number, fmt::format("a number from 0 to {}", kWidestMerge),
      "pixels, at the usual simplify of 0.25 and more or fewer in proportion to it: polygons that "
      "are nearer to each other become one block, gaps and courtyards that are narrower are "
      "filled; "
      "where coverage is \"auto\" or \"on\"; not set: as a file was prepared, else 0, none");
  setting.min = 0;
  setting.max = kWidestMerge;
  setting.get = [](const LayerConfig& layer) -> SettingValue {
    if (!layer.merge) return std::string();
    return *layer.merge;
  };
  setting.set = [](LayerConfig& layer, const SettingValue& value) {
    layer.merge = std::get<double>(value);
    return true;
  };
  return setting;
}

/// There is no list for "not set".
Setting<LayerConfig> attributes_setting() {
  auto setting = begin<LayerConfig>(
      "attributes", SettingType::list, "a list of names of attributes",
      "attributes that are kept, to filter and to colour by and to be told; not set: all");
  setting.get = [](const LayerConfig& layer) -> SettingValue {
    if (!layer.selection.attributes) return std::string();
    return *layer.selection.attributes;
  };
  setting.set = [](LayerConfig& layer, const SettingValue& value) {
    layer.selection.attributes = std::get<std::vector<std::string>>(value);
    return true;
  };
  return setting;
}

Setting<LayerConfig> max_skipped_setting() {
  auto setting = parsed<LayerConfig>(
      "max_skipped", [](auto& layer) -> auto& { return layer.max_skipped; },
      std::string(SkipLimit::kTakes), SkipLimit::parse,
      [](const SkipLimit& limit) { return limit.text(); },
      "how many of its features may be skipped, as a number or as a share of all in its source "
      "such "
      "as \"1%\"; if there are more, the layer is not taken");
  setting.type = SettingType::amount;
  return setting;
}

/// There is no number for "not set".
Setting<LayerConfig> detail_zoom_setting() {
  auto setting = begin<LayerConfig>(
      "detail_zoom", SettingType::integer, fmt::format("an integer from 0 to {}", kMaxZoom),
      "the zoom up to which its data is true: beyond it there is no more detail, only larger "
      "pictures; not set: unknown");
  setting.min = 0;
  setting.max = kMaxZoom;
  setting.get = [](const LayerConfig& layer) -> SettingValue {
    if (!layer.detail_zoom) return std::string();
    return std::int64_t{*layer.detail_zoom};
  };
  setting.set = [](LayerConfig& layer, const SettingValue& value) {
    layer.detail_zoom = static_cast<int>(std::get<std::int64_t>(value));
    return true;
  };
  return setting;
}

std::optional<ParameterId> layer_parameter(const std::string& name) {
  const StyleParameter* parameter = find_style_parameter(name);
  if (parameter == nullptr || !parameter->is_per_layer) return std::nullopt;
  return parameter->id;
}

std::string layer_parameter_names() {
  std::string names;
  for (const StyleParameter& parameter : style_parameters()) {
    if (!parameter.is_per_layer) continue;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", parameter.name);
  }
  return names;
}

template <typename Place>
Setting<Config> milliseconds(std::string_view name, Place place, int min, std::string help) {
  return integer<Config>(name, place, min, kMaxMilliseconds, std::move(help));
}

void append_server(std::vector<Setting<Config>>& all) {
  all.push_back(parsed<Config>(
      "server.address", [](auto& c) -> auto& { return c.server.address; },
      "an IPv4 or IPv6 address", listen_address, same,
      "the address to listen on; \"127.0.0.1\" to be reached from this machine only"));
  all.push_back(integer<Config>(
      "server.port", [](auto& c) -> auto& { return c.server.port; }, 0, 65'535,
      "the port; 0 takes any free one"));
  all.push_back(integer<Config>(
      "server.threads", [](auto& c) -> auto& { return c.server.threads; }, 1, 256,
      "threads for sockets"));
  all.push_back(integer<Config>(
      "server.workers", [](auto& c) -> auto& { return c.server.workers; }, 0, 256,
      "threads that draw; 0: one a core"));
  all.push_back(integer<Config>(
      "server.queue", [](auto& c) -> auto& { return c.server.queue; }, 1, 1'000'000,
      "tiles that may wait for a worker; more are answered with 503"));
  all.push_back(milliseconds(
      "server.deadline_ms", [](auto& c) -> auto& { return c.server.deadline_ms; }, 1,
      "a tile that takes longer, waiting and being drawn, is given up and answered with 504"));
  all.push_back(integer<Config>(
      "server.batch", [](auto& c) -> auto& { return c.server.batch; }, 1, 64,
      "tiles drawn in one pass, where that is faster than one by one"));
  all.push_back(integer<Config>(
      "server.cache_mb", [](auto& c) -> auto& { return c.server.cache_mb; }, 0, 1'000'000,
      "memory for tiles that were drawn; 0: none are kept"));
  all.push_back(integer<Config>(
      "server.posted_styles_mb", [](auto& c) -> auto& { return c.server.posted_styles_mb; }, 0,
      4096, "memory for styles that are posted"));
  all.push_back(parsed<Config>(
      "server.cache_control", [](auto& c) -> auto& { return c.server.cache_control; },
      "the value of a Cache-Control header", header_value, same,
      "what clients and proxies may do with tiles"));
  all.push_back(choice<RendererKind, Config>(
      "server.renderer", [](auto& c) -> auto& { return c.server.renderer.kind; }, renderer_words(),
      "what draws; \"auto\" tries the others in this order"));
  all.push_back(text<Config>(
      "server.device", [](auto& c) -> auto& { return c.server.renderer.device; },
      "the EGL device to prefer: its index, or a part of its name"));
  all.push_back(parsed<Config>(
      "server.public_url", [](auto& c) -> auto& { return c.server.public_url; },
      "a URL that begins with http:// or https://", public_url, same,
      "how the world names this server, for the URLs in documents; empty: by the Host of each "
      "request"));
  all.push_back(list<Config>(
      "server.allowed_hosts", [](auto& c) -> auto& { return c.server.allowed_hosts; },
      "a list of names of hosts, with or without a port, \"*.\" before them for all below",
      host_pattern, same,
      "without public_url: the Host headers that are answered; an empty list answers all"));
  auto sets = list<Config>(
      "server.tile_matrix_sets", [](auto& c) -> auto& { return c.server.tile_matrix_sets; },
      "a list of files",
      [](const std::string& file) { return file.empty() ? std::nullopt : std::optional(file); },
      same,
      "tile matrix sets besides those that are built in, as JSON of the OGC standard: tiles are "
      "served "
      "of layers whose crs names their reference system");
  sets.type = SettingType::paths;
  all.push_back(std::move(sets));
  all.push_back(path<Config>(
      "server.web_root", [](auto& c) -> auto& { return c.server.web_root; },
      "a folder whose files are served in the place of the viewer of the program; empty: none"));
  all.push_back(boolean<Config>(
      "server.metrics", [](auto& c) -> auto& { return c.server.metrics; },
      "whether /metrics is served here too, and not at the admin address only"));
  all.push_back(list<Config>(
      "server.trusted_proxies", [](auto& c) -> auto& { return c.server.trusted_proxies; },
      "a list of addresses or ranges such as \"10.0.0.0/8\"", parse_address_range, range_text,
      "proxies whose X-Forwarded-For says who asks; limits for one address do not hold for them"));
  all.push_back(milliseconds(
      "server.watch_ms", [](auto& c) -> auto& { return c.server.watch_ms; }, 0,
      "time between looks at the configuration and the files of layers, which are read again when "
      "they have changed; 0: only on SIGHUP"));
  all.push_back(milliseconds(
      "server.live_ms", [](auto& c) -> auto& { return c.server.live_ms; }, 10,
      "time between questions to the databases of layers with a live_query"));
  all.push_back(milliseconds(
      "server.drain_delay_ms", [](auto& c) -> auto& { return c.server.drain_delay_ms; }, 0,
      "told to stop, the server is not ready but goes on so long, for balancers to notice"));
  all.push_back(milliseconds(
      "server.drain_timeout_ms", [](auto& c) -> auto& { return c.server.drain_timeout_ms; }, 1,
      "then it takes no more connections, and waits so long for what is under way"));
}

void append_limits(std::vector<Setting<Config>>& all) {
  all.push_back(integer<Config>(
      "limits.connections", [](auto& c) -> auto& { return c.limits.connections; }, 1, 1'000'000,
      "connections in all; more are turned away with 503"));
  all.push_back(integer<Config>(
      "limits.connections_per_address",
      [](auto& c) -> auto& { return c.limits.connections_per_address; }, 1, 1'000'000,
      "connections of one IPv4 address or IPv6 /64; more are turned away with 429"));
  all.push_back(integer<Config>(
      "limits.header_bytes", [](auto& c) -> auto& { return c.limits.header_bytes; }, 512, 32'768,
      "request line and header together; more is answered with 431"));
  all.push_back(integer<Config>(
      "limits.target_bytes", [](auto& c) -> auto& { return c.limits.target_bytes; }, 128,
      static_cast<std::int64_t>(kMaxTargetLength),
      "path and query together; more is answered with 414"));
  all.push_back(integer<Config>(
      "limits.body_bytes", [](auto& c) -> auto& { return c.limits.body_bytes; }, 0, 1 << 20,
      "a style that is posted; more is answered with 413"));
  all.push_back(integer<Config>(
      "limits.layers", [](auto& c) -> auto& { return c.limits.layers; }, 1,
      static_cast<std::int64_t>(kMaxLayersPerTile), "layers of one tile"));
  all.push_back(integer<Config>(
      "limits.scale", [](auto& c) -> auto& { return c.limits.scale; }, 1, kMaxScale,
      "pixels of a tile's side in 256ths: 2 allows @2x"));
  all.push_back(integer<Config>(
      "limits.zoom", [](auto& c) -> auto& { return c.limits.zoom; }, 0, kMaxZoom,
      "the last zoom; tiles beyond it are answered with 404"));
  all.push_back(integer<Config>(
      "limits.map_pixels", [](auto& c) -> auto& { return c.limits.map_pixels; }, 1,
      static_cast<std::int64_t>(kMaxMapPixels),
      "pixels of a picture of a window, width times height; more are answered with 400"));
  all.push_back(milliseconds(
      "limits.idle_timeout_ms", [](auto& c) -> auto& { return c.limits.idle_timeout_ms; }, 1,
      "how long a connection is kept that asks for nothing"));
  all.push_back(milliseconds(
      "limits.read_timeout_ms", [](auto& c) -> auto& { return c.limits.read_timeout_ms; }, 1,
      "how long a request may take to come, from its first byte to its last"));
  all.push_back(milliseconds(
      "limits.write_timeout_ms", [](auto& c) -> auto& { return c.limits.write_timeout_ms; }, 1,
      "how long a client may take to receive an answer"));
  all.push_back(number<Config>(
      "limits.drawn_per_second", [](auto& c) -> auto& { return c.limits.drawn_per_second; }, 0, 1e6,
      "tiles that are not in the cache, for one IPv4 address or IPv6 /64, on the average; more are "
      "answered with 429; 0: no limit"));
  all.push_back(number<Config>(
      "limits.drawn_burst", [](auto& c) -> auto& { return c.limits.drawn_burst; }, 1, 1e6,
      "how many of them it may ask for at once after a rest"));
  all.push_back(integer<Config>(
      "limits.tile_cost", [](auto& c) -> auto& { return c.limits.tile_cost; }, 0, 4'000'000'000,
      "what drawing one tile may cost, as the header X-Tile-Cost tells: a worker draws some 25 "
      "million a second; more is answered with 400; 0: no limit"));
  all.push_back(number<Config>(
      "limits.cost_per_second", [](auto& c) -> auto& { return c.limits.cost_per_second; }, 0, 1e12,
      "what tiles that cost more than 250,000 each may cost, for one IPv4 address or IPv6 /64, on "
      "the average; more is answered with 429; 0: no limit"));
  all.push_back(number<Config>(
      "limits.cost_burst", [](auto& c) -> auto& { return c.limits.cost_burst; }, 1, 1e12,
      "how much of that it may ask for at once after a rest"));
  all.push_back(integer<Config>(
      "limits.values_bytes", [](auto& c) -> auto& { return c.limits.values_bytes; }, 0, 64 << 20,
      "a table that is posted to /values; more is answered with 413"));
  all.push_back(integer<Config>(
      "limits.values_rows", [](auto& c) -> auto& { return c.limits.values_rows; }, 1, 10'000'000,
      "rows of such a table; more are answered with 413"));
  all.push_back(integer<Config>(
      "limits.values_mb", [](auto& c) -> auto& { return c.limits.values_mb; }, 0, 65'536,
      "memory for tables that are posted: those not asked for longest are given up for others; 0: "
      "none are kept"));
}

void append_viewer(std::vector<Setting<Config>>& all) {
  all.push_back(text<Config>(
      "viewer.title", [](auto& c) -> auto& { return c.viewer.title; },
      "the heading of the viewer"));
  all.push_back(parsed<Config>(
      "viewer.start", [](auto& c) -> auto& { return c.viewer.start; },
      "what stands after # in an address of the viewer", start_of_viewer, same,
      "what the viewer shows where its address says nothing: copy it from the address of a map as "
      "it should be; empty: all that is served, fitted to the window"));
}

void append_text(std::vector<Setting<Config>>& all) {
  auto fonts = list<Config>(
      "text.fonts", [](auto& c) -> auto& { return c.text.fonts; },
      "a list of files of fonts, of a collection \"FILE#N\", its font number N from 0",
      [](const std::string& file) { return file.empty() ? std::nullopt : std::optional(file); },
      same,
      "the fonts of legends, labels and marks: each character is of the first that has it; an "
      "empty list: "
      "those of the Debian packages fonts-dejavu-core, fonts-noto-core and fonts-noto-cjk that are "
      "installed");
  fonts.type = SettingType::paths;
  all.push_back(std::move(fonts));
}

void append_log_and_admin(std::vector<Setting<Config>>& all) {
  all.push_back(choice<std::string, Config>(
      "log.level", [](auto& c) -> auto& { return c.log.level; }, level_words(),
      "the least that the log on standard error tells"));
  auto access = path<Config>(
      "log.access", [](auto& c) -> auto& { return c.log.access; },
      "a line for every request: \"stdout\", \"stderr\" or a file, which SIGHUP opens again; "
      "empty: "
      "none");
  access.choices = {"stdout", "stderr"};
  all.push_back(std::move(access));
  all.push_back(choice<LogFormat, Config>(
      "log.access_format", [](auto& c) -> auto& { return c.log.access_format; }, format_words(),
      "the lines as web servers write them, or as JSON"));
  all.push_back(parsed<Config>(
      "admin.address", [](auto& c) -> auto& { return c.admin.address; }, "an IPv4 or IPv6 address",
      listen_address, same, "a second address, for /metrics and the details of /ready"));
  all.push_back(integer<Config>(
      "admin.port", [](auto& c) -> auto& { return c.admin.port; }, 0, 65'535,
      "its port; 0: there is none"));
  all.push_back(parsed<Config>(
      "changes.zooms", [](auto& c) -> auto& { return c.changes.zooms; },
      "a zoom or a range of them such as \"0-14\", or nothing",
      [](const std::string& text) {
        return text.empty() || parse_zooms(text) ? std::optional(text) : std::nullopt;
      },
      same,
      "the zooms for which the tiles are found that may look different when layers have been read "
      "again, for /changes at the admin address and for changes.command; empty: none"));
  all.push_back(text<Config>(
      "changes.command", [](auto& c) -> auto& { return c.changes.command; },
      "what a shell is to do then: its input has a line \"LAYER Z/X/Y\" for each tile; empty: "
      "nothing"));
}

}  // namespace

const std::vector<Setting<Config>>& config_settings() {
  static const auto settings = [] {
    std::vector<Setting<Config>> all;
    append_server(all);
    append_viewer(all);
    append_limits(all);
    append_text(all);
    append_log_and_admin(all);
    return all;
  }();
  return settings;
}

const std::vector<Setting<ValueTableConfig>>& value_table_settings() {
  static const std::vector<Setting<ValueTableConfig>> settings = {
      path<ValueTableConfig>(
          "values.file", [](auto& table) -> auto& { return table.file; },
          "rows of keys and values, as CSV with a line of names, or as JSON; read again when it "
          "has "
          "changed"),
      text<ValueTableConfig>(
          "values.key", [](auto& table) -> auto& { return table.key; },
          "the column of keys; empty: the first"),
      text<ValueTableConfig>(
          "values.value", [](auto& table) -> auto& { return table.value; },
          "the column of values; empty: the second"),
      text<ValueTableConfig>(
          "values.title", [](auto& table) -> auto& { return table.title; },
          "what the values are, for people; empty: the name of their column"),
      text<ValueTableConfig>(
          "values.attribution", [](auto& table) -> auto& { return table.attribution; },
          "what maps must say about where they are from; may hold links in HTML"),
      list<ValueTableConfig>(
          "values.languages", [](auto& table) -> auto& { return table.languages; },
          R"(a list of tags of languages such as ["de", "zh-Hans"])",
          [](const std::string& tag) {
            return is_language_tag(tag) ? std::optional(tag) : std::nullopt;
          },
          same,
          "languages in which the table has the values, too, each in a column called as that of "
          "the "
          "values, a colon and the tag, such as name:de: labels show them where label-language "
          "asks "
          "for one")};
  return settings;
}

const std::vector<Setting<FontsConfig>>& fonts_settings() {
  static const std::vector<Setting<FontsConfig>> settings = [] {
    auto files = list<FontsConfig>(
        "fonts.files", [](auto& fonts) -> auto& { return fonts.files; },
        "a list of files of fonts, of a collection \"FILE#N\", its font number N from 0",
        [](const std::string& file) { return file.empty() ? std::nullopt : std::optional(file); },
        same,
        "the fonts that labels with this label-font are written in: each character is of the "
        "first that has it");
    files.type = SettingType::paths;
    return std::vector<Setting<FontsConfig>>{std::move(files)};
  }();
  return settings;
}

const std::vector<Setting<LayerConfig>>& layer_settings() {
  static const std::vector<Setting<LayerConfig>> settings = {
      parsed<LayerConfig>(
          "name", [](auto& layer) -> auto& { return layer.name; },
          "1 to 64 letters, digits, '_' or '-'",
          [](const std::string& name) {
            return is_url_name(name) ? std::optional(name) : std::nullopt;
          },
          same, "the layer as it appears in URLs"),
      path<LayerConfig>(
          "file", [](auto& layer) -> auto& { return layer.file; },
          "polygons in a format that GDAL reads, or a prepared file"),
      text<LayerConfig>(
          "source_layer", [](auto& layer) -> auto& { return layer.selection.layer; },
          "the layer or table of the file or database; not set: all that hold polygons"),
      text<LayerConfig>(
          "where", [](auto& layer) -> auto& { return layer.selection.where; },
          "a condition on features in SQL; not set: all of them"),
      attributes_setting(),
      text<LayerConfig>(
          "live_query", [](auto& layer) -> auto& { return layer.live_query; },
          "SQL that tells which features have changed, so that only those are read again: each row "
          "a number that grows and the id of a feature, with a number greater than {since}"),
      path<LayerConfig>(
          "prepared", [](auto& layer) -> auto& { return layer.prepared; },
          "made of the file by `trapeze prepare`, and served in its place; parts of it by a name "
          "in "
          "which * stands for any characters, such as \"parts/*.trapeze\""),
      text<LayerConfig>(
          "title", [](auto& layer) -> auto& { return layer.title; },
          "for people; the name if it is not set"),
      text<LayerConfig>(
          "attribution", [](auto& layer) -> auto& { return layer.attribution; },
          "what maps must say about where it is from; may hold links in HTML"),
      text<LayerConfig>(
          "description", [](auto& layer) -> auto& { return layer.description; }, "what it shows"),
      integer<LayerConfig>(
          "min_zoom", [](auto& layer) -> auto& { return layer.min_zoom; }, 0, kMaxZoom,
          "the first zoom at which it is drawn"),
      integer<LayerConfig>(
          "max_zoom", [](auto& layer) -> auto& { return layer.max_zoom; }, 0, kMaxZoom,
          "the last zoom at which it is drawn"),
      detail_zoom_setting(),
      text<LayerConfig>(
          "group", [](auto& layer) -> auto& { return layer.group; },
          "a heading for layers that belong together; not set: none"),
      text<LayerConfig>(
          "title_attribute", [](auto& layer) -> auto& { return layer.title_attribute; },
          "the attribute that features are called by; not set: one named name, name:en, name_en, "
          "title or label, in any case of letters"),
      list<LayerConfig>(
          "crs", [](auto& layer) -> auto& { return layer.crs; },
          "a list of reference systems such as [\"EPSG:3857\", \"EPSG:2056\"], EPSG:3857 among "
          "them",
          [](const std::string& name) { return name.empty() ? std::nullopt : std::optional(name); },
          same,
          "the reference systems that it is built for, on a grid of its own each, which takes as "
          "much "
          "memory again; maps in EPSG:4326 and CRS:84 are made of EPSG:3857; not set: EPSG:3857"),
      weights_setting(),
      coverage_setting(),
      close_gaps_setting(),
      merge_setting(),
      text<LayerConfig>(
          "merge_by", [](auto& layer) -> auto& { return layer.merge_by; },
          "the attribute by which polygons become blocks: only those with the same value of it do; "
          "not set: as a file was prepared, else whatever they are"),
      boolean<LayerConfig>(
          "fast_topology", [](auto& layer) -> auto& { return layer.fast_topology; },
          "whether requests may ask for topology=fast, polygons apart and without the test of "
          "topology: it is then built a second time, and takes twice the memory"),
      max_skipped_setting(),
      boolean<LayerConfig>(
          "may_shrink", [](auto& layer) -> auto& { return layer.may_shrink; },
          "whether it is taken if it has fewer than half of its features when its file is read "
          "again; otherwise the old layers stay"),
      list<LayerConfig>(
          "locked", [](auto& layer) -> auto& { return layer.locked; },
          "a list of parameters that are set for one layer: " + layer_parameter_names(),
          layer_parameter, [](ParameterId id) { return std::string(style_parameter(id).name); },
          "parameters that requests cannot set for it")};
  return settings;
}

}  // namespace trapeze
