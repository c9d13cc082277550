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
      "how the importance of a vertex is measured; default: the rule a file was prepared with, "
      "else \"" +
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
      "whether neighbouring polygons keep shared borders: \"auto\", polygons that share an edge "
      "and overlap by at most 1 %; \"on\", all polygons near each other, however much they "
      "overlap; \"off\", each polygon is simplified separately; default: the mode a file was "
      "prepared with, else \"" +
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
      "close gaps and overlaps between polygons up to this width, in metres on the ground; needs "
      "coverage \"auto\" or \"on\"; default: the width a file was prepared with, else 0");
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
      "merge polygons closer than this distance into blocks and fill narrower gaps and courtyards; "
      "in pixels at the default simplify of 0.25, scaled in proportion to simplify; needs coverage "
      "\"auto\" or \"on\"; default: the distance a file was prepared with, else 0, which disables "
      "merging");
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
  auto setting =
      begin<LayerConfig>("attributes", SettingType::list, "a list of names of attributes",
                         "attributes to keep, for filters, colours and /identify; default: all");
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
      "how many features may be skipped, as a number or as a share of all features in the source "
      "such as \"1%\"; if more are skipped, the layer is rejected");
  setting.type = SettingType::amount;
  return setting;
}

/// There is no number for "not set".
Setting<LayerConfig> detail_zoom_setting() {
  auto setting = begin<LayerConfig>("detail_zoom", SettingType::integer,
                                    fmt::format("an integer from 0 to {}", kMaxZoom),
                                    "the last zoom at which the data adds detail; higher zooms "
                                    "only enlarge it; default: unknown");
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
      "the address to listen on; \"127.0.0.1\" accepts connections from this machine only"));
  all.push_back(integer<Config>(
      "server.port", [](auto& c) -> auto& { return c.server.port; }, 0, 65'535,
      "the port to listen on; 0 picks a free one"));
  all.push_back(integer<Config>(
      "server.threads", [](auto& c) -> auto& { return c.server.threads; }, 1, 256,
      "threads for network I/O"));
  all.push_back(integer<Config>(
      "server.workers", [](auto& c) -> auto& { return c.server.workers; }, 0, 256,
      "rendering threads; 0: one per core"));
  all.push_back(integer<Config>(
      "server.queue", [](auto& c) -> auto& { return c.server.queue; }, 1, 1'000'000,
      "requests that may wait for a rendering thread; further ones get 503"));
  all.push_back(milliseconds(
      "server.deadline_ms", [](auto& c) -> auto& { return c.server.deadline_ms; }, 1,
      "time limit for a tile, waiting and rendering together; a tile that takes longer is "
      "abandoned and answered with 504"));
  all.push_back(integer<Config>(
      "server.batch", [](auto& c) -> auto& { return c.server.batch; }, 1, 64,
      "tiles rendered in one pass, where that is faster than one at a time"));
  all.push_back(integer<Config>(
      "server.cache_mb", [](auto& c) -> auto& { return c.server.cache_mb; }, 0, 1'000'000,
      "memory for the cache of rendered tiles; 0 disables it"));
  all.push_back(integer<Config>(
      "server.posted_styles_mb", [](auto& c) -> auto& { return c.server.posted_styles_mb; }, 0,
      4096, "memory for posted styles"));
  all.push_back(parsed<Config>(
      "server.cache_control", [](auto& c) -> auto& { return c.server.cache_control; },
      "the value of a Cache-Control header", header_value, same,
      "the Cache-Control header of tiles"));
  all.push_back(choice<RendererKind, Config>(
      "server.renderer", [](auto& c) -> auto& { return c.server.renderer.kind; }, renderer_words(),
      "the renderer; \"auto\" tries the others in this order"));
  all.push_back(text<Config>(
      "server.device", [](auto& c) -> auto& { return c.server.renderer.device; },
      "the preferred EGL device: its index, or part of its name"));
  all.push_back(parsed<Config>(
      "server.public_url", [](auto& c) -> auto& { return c.server.public_url; },
      "a URL that begins with http:// or https://", public_url, same,
      "the public base URL of this server, used for URLs in documents; empty: taken from the Host "
      "header of each request"));
  all.push_back(list<Config>(
      "server.allowed_hosts", [](auto& c) -> auto& { return c.server.allowed_hosts; },
      "a list of host names, with or without a port; \"*.\" in front matches all subdomains",
      host_pattern, same,
      "accepted Host headers if public_url is empty; an empty list accepts all"));
  auto sets = list<Config>(
      "server.tile_matrix_sets", [](auto& c) -> auto& { return c.server.tile_matrix_sets; },
      "a list of files",
      [](const std::string& file) { return file.empty() ? std::nullopt : std::optional(file); },
      same,
      "files with additional tile matrix sets, in the JSON of the OGC standard; they apply to "
      "layers whose crs includes the reference system of the set");
  sets.type = SettingType::paths;
  all.push_back(std::move(sets));
  all.push_back(path<Config>(
      "server.web_root", [](auto& c) -> auto& { return c.server.web_root; },
      "a folder of files to serve instead of the built-in viewer; empty: none"));
  all.push_back(boolean<Config>(
      "server.metrics", [](auto& c) -> auto& { return c.server.metrics; },
      "whether /metrics is also served here, not only at the admin address"));
  all.push_back(list<Config>(
      "server.trusted_proxies", [](auto& c) -> auto& { return c.server.trusted_proxies; },
      "a list of addresses or CIDR ranges such as \"10.0.0.0/8\"", parse_address_range, range_text,
      "proxies whose X-Forwarded-For header names the client; limits per address do not apply to "
      "the proxies themselves"));
  all.push_back(milliseconds(
      "server.watch_ms", [](auto& c) -> auto& { return c.server.watch_ms; }, 0,
      "interval for checking whether the configuration or layer files have changed; changed ones "
      "are read again; 0: only on SIGHUP"));
  all.push_back(milliseconds(
      "server.live_ms", [](auto& c) -> auto& { return c.server.live_ms; }, 10,
      "polling interval for databases of layers with a live_query"));
  all.push_back(milliseconds(
      "server.drain_delay_ms", [](auto& c) -> auto& { return c.server.drain_delay_ms; }, 0,
      "after a signal to stop, time during which the server keeps serving but reports not ready, "
      "so that load balancers notice"));
  all.push_back(milliseconds(
      "server.drain_timeout_ms", [](auto& c) -> auto& { return c.server.drain_timeout_ms; }, 1,
      "time the server then waits for requests in progress, without accepting new connections"));
}

void append_limits(std::vector<Setting<Config>>& all) {
  all.push_back(integer<Config>(
      "limits.connections", [](auto& c) -> auto& { return c.limits.connections; }, 1, 1'000'000,
      "total connections; further ones are rejected with 503"));
  all.push_back(integer<Config>(
      "limits.connections_per_address",
      [](auto& c) -> auto& { return c.limits.connections_per_address; }, 1, 1'000'000,
      "connections per IPv4 address or IPv6 /64; further ones are rejected with 429"));
  all.push_back(integer<Config>(
      "limits.header_bytes", [](auto& c) -> auto& { return c.limits.header_bytes; }, 512, 32'768,
      "size of request line and headers; larger requests get 431"));
  all.push_back(integer<Config>(
      "limits.target_bytes", [](auto& c) -> auto& { return c.limits.target_bytes; }, 128,
      static_cast<std::int64_t>(kMaxTargetLength),
      "length of path and query; longer ones get 414"));
  all.push_back(integer<Config>(
      "limits.body_bytes", [](auto& c) -> auto& { return c.limits.body_bytes; }, 0, 1 << 20,
      "size of a posted style; larger ones get 413"));
  all.push_back(integer<Config>(
      "limits.layers", [](auto& c) -> auto& { return c.limits.layers; }, 1,
      static_cast<std::int64_t>(kMaxLayersPerTile), "layers per tile"));
  all.push_back(integer<Config>(
      "limits.scale", [](auto& c) -> auto& { return c.limits.scale; }, 1, kMaxScale,
      "the highest scale of a tile: its side divided by 256 pixels; 2 allows @2x"));
  all.push_back(integer<Config>(
      "limits.zoom", [](auto& c) -> auto& { return c.limits.zoom; }, 0, kMaxZoom,
      "the highest zoom; tiles beyond it get 404"));
  all.push_back(integer<Config>(
      "limits.map_pixels", [](auto& c) -> auto& { return c.limits.map_pixels; }, 1,
      static_cast<std::int64_t>(kMaxMapPixels),
      "pixels of an image from /map or WMS, width times height; larger ones get 400"));
  all.push_back(milliseconds(
      "limits.idle_timeout_ms", [](auto& c) -> auto& { return c.limits.idle_timeout_ms; }, 1,
      "how long an idle connection is kept open"));
  all.push_back(milliseconds(
      "limits.read_timeout_ms", [](auto& c) -> auto& { return c.limits.read_timeout_ms; }, 1,
      "how long a client may take to send a request, from first to last byte"));
  all.push_back(milliseconds(
      "limits.write_timeout_ms", [](auto& c) -> auto& { return c.limits.write_timeout_ms; }, 1,
      "how long a client may take to receive a response"));
  all.push_back(number<Config>(
      "limits.drawn_per_second", [](auto& c) -> auto& { return c.limits.drawn_per_second; }, 0, 1e6,
      "average rate of tiles rendered for one IPv4 address or IPv6 /64, cache hits not counted; "
      "beyond it 429; 0: no limit"));
  all.push_back(number<Config>(
      "limits.drawn_burst", [](auto& c) -> auto& { return c.limits.drawn_burst; }, 1, 1e6,
      "how many of these tiles a client may request in a burst"));
  all.push_back(integer<Config>(
      "limits.tile_cost", [](auto& c) -> auto& { return c.limits.tile_cost; }, 0, 4'000'000'000,
      "cost of a single tile, as reported in the X-Tile-Cost header; a rendering thread handles "
      "about 25 million per second; more expensive tiles get 400; 0: no limit"));
  all.push_back(number<Config>(
      "limits.cost_per_second", [](auto& c) -> auto& { return c.limits.cost_per_second; }, 0, 1e12,
      "average cost per second for one IPv4 address or IPv6 /64, counting tiles that cost more "
      "than 250,000; beyond it 429; 0: no limit"));
  all.push_back(number<Config>(
      "limits.cost_burst", [](auto& c) -> auto& { return c.limits.cost_burst; }, 1, 1e12,
      "how much of that cost a client may request in a burst"));
  all.push_back(integer<Config>(
      "limits.values_bytes", [](auto& c) -> auto& { return c.limits.values_bytes; }, 0, 64 << 20,
      "size of a table posted to /values; larger ones get 413"));
  all.push_back(integer<Config>(
      "limits.values_rows", [](auto& c) -> auto& { return c.limits.values_rows; }, 1, 10'000'000,
      "rows of a posted table; more get 413"));
  all.push_back(integer<Config>(
      "limits.values_mb", [](auto& c) -> auto& { return c.limits.values_mb; }, 0, 65'536,
      "memory for posted tables; the least recently used are dropped; 0: none are kept"));
}

void append_viewer(std::vector<Setting<Config>>& all) {
  all.push_back(text<Config>(
      "viewer.title", [](auto& c) -> auto& { return c.viewer.title; },
      "the heading of the viewer"));
  all.push_back(parsed<Config>(
      "viewer.start", [](auto& c) -> auto& { return c.viewer.start; },
      "the part after # of a viewer URL", start_of_viewer, same,
      "the initial view of the viewer: the part after # copied from its address; empty: all "
      "layers, fitted to the window"));
}

void append_text(std::vector<Setting<Config>>& all) {
  auto fonts = list<Config>(
      "text.fonts", [](auto& c) -> auto& { return c.text.fonts; },
      "a list of font files; \"FILE#N\" selects font N of a collection, counted from 0",
      [](const std::string& file) { return file.empty() ? std::nullopt : std::optional(file); },
      same,
      "fonts for legends, labels and debug marks; each character is taken from the first font that "
      "has it; an empty list: the installed ones of the Debian packages fonts-dejavu-core, "
      "fonts-noto-core and fonts-noto-cjk");
  fonts.type = SettingType::paths;
  all.push_back(std::move(fonts));
}

void append_log_and_admin(std::vector<Setting<Config>>& all) {
  all.push_back(choice<std::string, Config>(
      "log.level", [](auto& c) -> auto& { return c.log.level; }, level_words(),
      "the minimum severity of log messages on standard error"));
  auto access = path<Config>(
      "log.access", [](auto& c) -> auto& { return c.log.access; },
      "where to log requests: \"stdout\", \"stderr\" or a file, which SIGHUP reopens; empty: "
      "nowhere");
  access.choices = {"stdout", "stderr"};
  all.push_back(std::move(access));
  all.push_back(choice<LogFormat, Config>(
      "log.access_format", [](auto& c) -> auto& { return c.log.access_format; }, format_words(),
      "format of the request log: combined log format of web servers, or JSON"));
  all.push_back(parsed<Config>(
      "admin.address", [](auto& c) -> auto& { return c.admin.address; }, "an IPv4 or IPv6 address",
      listen_address, same,
      "a second address to listen on, for /metrics and the details of /ready"));
  all.push_back(integer<Config>(
      "admin.port", [](auto& c) -> auto& { return c.admin.port; }, 0, 65'535,
      "its port; 0 disables it"));
  all.push_back(parsed<Config>(
      "changes.zooms", [](auto& c) -> auto& { return c.changes.zooms; },
      "a zoom or a range of zooms such as \"0-14\", or nothing",
      [](const std::string& text) {
        return text.empty() || parse_zooms(text) ? std::optional(text) : std::nullopt;
      },
      same,
      "the zooms at which changed tiles are determined after a reload, for /changes at the admin "
      "address and for changes.command; empty: none"));
  all.push_back(text<Config>(
      "changes.command", [](auto& c) -> auto& { return c.changes.command; },
      "a shell command to run after a reload, with a line \"LAYER Z/X/Y\" for each changed tile on "
      "its standard input; empty: none"));
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
          "a file with rows of keys and values, as CSV with a header line or as JSON; read again "
          "when it changes"),
      text<ValueTableConfig>(
          "values.key", [](auto& table) -> auto& { return table.key; },
          "the column with the keys; empty: the first column"),
      text<ValueTableConfig>(
          "values.value", [](auto& table) -> auto& { return table.value; },
          "the column with the values; empty: the second column"),
      text<ValueTableConfig>(
          "values.title", [](auto& table) -> auto& { return table.title; },
          "a title for the values; empty: the name of their column"),
      text<ValueTableConfig>(
          "values.attribution", [](auto& table) -> auto& { return table.attribution; },
          "the attribution that maps must show; may contain HTML links"),
      list<ValueTableConfig>(
          "values.languages", [](auto& table) -> auto& { return table.languages; },
          R"(a list of tags of languages such as ["de", "zh-Hans"])",
          [](const std::string& tag) {
            return is_language_tag(tag) ? std::optional(tag) : std::nullopt;
          },
          same,
          "languages for which the table has translated values, each in a column named after the "
          "value column with a colon and the language tag, such as name:de; label-language selects "
          "one for labels")};
  return settings;
}

const std::vector<Setting<FontsConfig>>& fonts_settings() {
  static const std::vector<Setting<FontsConfig>> settings = [] {
    auto files = list<FontsConfig>(
        "fonts.files", [](auto& fonts) -> auto& { return fonts.files; },
        "a list of font files; \"FILE#N\" selects font N of a collection, counted from 0",
        [](const std::string& file) { return file.empty() ? std::nullopt : std::optional(file); },
        same,
        "the fonts for labels with this label-font; each character is taken from the first font "
        "that has it");
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
          same, "the name of the layer in URLs"),
      path<LayerConfig>(
          "file", [](auto& layer) -> auto& { return layer.file; },
          "polygons in a format that GDAL reads, or a prepared file"),
      text<LayerConfig>(
          "source_layer", [](auto& layer) -> auto& { return layer.selection.layer; },
          "the layer or table of the file or database; default: all that contain polygons"),
      text<LayerConfig>(
          "where", [](auto& layer) -> auto& { return layer.selection.where; },
          "an SQL condition that selects features; default: all features"),
      attributes_setting(),
      text<LayerConfig>(
          "live_query", [](auto& layer) -> auto& { return layer.live_query; },
          "an SQL query for changed features, so that only these are read again; it returns rows "
          "with an increasing number and a feature id, for numbers greater than {since}"),
      path<LayerConfig>(
          "prepared", [](auto& layer) -> auto& { return layer.prepared; },
          "a file made by `trapeze prepare`, served instead of the source; for a layer in parts a "
          "pattern such as \"parts/*.trapeze\""),
      text<LayerConfig>(
          "title", [](auto& layer) -> auto& { return layer.title; },
          "a title for people; default: the name"),
      text<LayerConfig>(
          "attribution", [](auto& layer) -> auto& { return layer.attribution; },
          "the attribution that maps must show; may contain HTML links"),
      text<LayerConfig>(
          "description", [](auto& layer) -> auto& { return layer.description; },
          "a description for people"),
      integer<LayerConfig>(
          "min_zoom", [](auto& layer) -> auto& { return layer.min_zoom; }, 0, kMaxZoom,
          "the first zoom at which the layer is drawn"),
      integer<LayerConfig>(
          "max_zoom", [](auto& layer) -> auto& { return layer.max_zoom; }, 0, kMaxZoom,
          "the last zoom at which the layer is drawn"),
      detail_zoom_setting(),
      text<LayerConfig>(
          "group", [](auto& layer) -> auto& { return layer.group; },
          "a heading under which layers are grouped; default: none"),
      text<LayerConfig>(
          "title_attribute", [](auto& layer) -> auto& { return layer.title_attribute; },
          "the attribute that holds the title of a feature; default: the first of name, name:en, "
          "name_en, title or label, ignoring case"),
      list<LayerConfig>(
          "crs", [](auto& layer) -> auto& { return layer.crs; },
          "a list of reference systems that includes EPSG:3857, such as [\"EPSG:3857\", "
          "\"EPSG:2056\"]",
          [](const std::string& name) { return name.empty() ? std::nullopt : std::optional(name); },
          same,
          "the reference systems the layer is built for; each needs a grid of its own and as much "
          "memory again; maps in EPSG:4326 and CRS:84 are derived from EPSG:3857; default: "
          "EPSG:3857"),
      weights_setting(),
      coverage_setting(),
      close_gaps_setting(),
      merge_setting(),
      text<LayerConfig>(
          "merge_by", [](auto& layer) -> auto& { return layer.merge_by; },
          "merge only polygons with equal values of this attribute; default: the attribute a file "
          "was prepared with, else all polygons are merged"),
      boolean<LayerConfig>(
          "fast_topology", [](auto& layer) -> auto& { return layer.fast_topology; },
          "whether requests may use topology=fast, which simplifies polygons separately and "
          "without the topology test; the layer is then built twice and needs twice the memory"),
      max_skipped_setting(),
      boolean<LayerConfig>(
          "may_shrink", [](auto& layer) -> auto& { return layer.may_shrink; },
          "whether a reload is accepted when the layer has lost more than half of its features; "
          "otherwise the old data stays"),
      list<LayerConfig>(
          "locked", [](auto& layer) -> auto& { return layer.locked; },
          "a list of style parameters of layers: " + layer_parameter_names(), layer_parameter,
          [](ParameterId id) { return std::string(style_parameter(id).name); },
          "style parameters that requests cannot override for this layer")};
  return settings;
}

}  // namespace trapeze
