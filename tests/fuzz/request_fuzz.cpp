// Request targets, as clients send them: each is decoded strictly, then refused with a message or
// turned into a plan. Each plan has one canonical target, which leads to the same picture.
//
// Input: lines of a target, a Host, an If-None-Match and an X-Forwarded-For. Missing lines are
// empty.
#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/url.h"
#include "server/http/client_address.h"
#include "server/http/http_message.h"
#include "server/styles/style_book.h"
#include "server/styles/style_document.h"
#include "server/tiles/tile_plan.h"
#include "server/tiles/tile_request.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/sample_layers.h"

namespace trapeze {
namespace {

using fuzzing::require;

struct Input {
  std::array<std::string, 4> lines;

  explicit Input(std::string_view text) {
    for (std::string& line : lines) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }
  const std::string& target() const { return lines[0]; }
  const std::string& host() const { return lines[1]; }
  const std::string& if_none_match() const { return lines[2]; }
  const std::string& forwarded_for() const { return lines[3]; }
};

/// A configured style with a setting for one layer, as `style=night`.
const StyleBook& styles() {
  static const StyleBook book({{"night", *parse_style_document(
                                             R"({"fill": "navy", "land.stroke": "#fff8",
            "color-by": "rank", "breaks": [2, 5], "ramp": "Blues"})")}});
  return book;
}

const std::shared_ptr<const Dataset>& layers() {
  static const auto layers = fuzzing::sample_layers();
  return layers;
}

void check_problem(const Problem& problem) {
  require(problem.status >= 400 && problem.status < 500, "a problem of the client is no 4xx");
  const auto json = nlohmann::json::parse(problem_json(problem), nullptr, false);
  require(json.is_object() && json["status"] == problem.status, "a problem is no JSON");
}

std::string encoded_path(const std::vector<std::string>& segments) {
  std::string path;
  for (const std::string& segment : segments) path += '/' + percent_encode(segment);
  return path;
}

std::string encoded_query(const std::vector<QueryPair>& pairs) {
  std::string query;
  for (const auto& [name, value] : pairs) {
    // A pair without a name or a value is still a pair.
    query += (query.empty() ? "" : "&") + percent_encode(name) + '=' + percent_encode(value);
  }
  return query;
}

void check_decoding(const std::string& text) {
  const auto target = split_target(text);
  if (!target) return;
  require(target->path.starts_with('/'), "a path does not begin with a slash");
  if (const auto path = decode_path(target->path)) {
    require(decode_path(encoded_path(*path)) == path, "a path is another one after encoding");
  }
  if (const auto query = decode_query(target->query)) {
    require(decode_query(encoded_query(*query)) == query, "a query is another after encoding");
  }
}

std::string joined(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ",") + name;
  return list;
}

std::string canonical_target(const TileRequest& request) {
  return "/tiles/" + joined(request.layers) + '/' + std::to_string(request.tile.z) + '/' +
         std::to_string(request.tile.x) + '/' + std::to_string(request.tile.y) + '@' +
         std::to_string(request.scale) + (request.format == TileFormat::webp ? "x.webp" : "x.png") +
         '?' + request.style.canonical_text();
}

std::string canonical_target(const TileJsonRequest& request) {
  return "/tiles/" + joined(request.layers) + scale_suffix(request.scale) + ".json?" +
         request.style.query();
}

void check_plan(const TileRequest& request, const TileRequest& again) {
  const auto plan = plan_tile(request, layers());
  if (!plan) return check_problem(plan.problem());
  const auto plan_again = plan_tile(again, layers());
  require(bool{plan_again}, "the canonical target has no plan");
  require(plan->key() == plan_again->key(), "the canonical target is another tile");
}

void check_tiles(const std::string& target) {
  const auto split = split_target(target);
  if (!split) return;
  const auto parsed = parse_tiles_target(*split, styles());
  if (!parsed) return check_problem(parsed.problem());
  const auto& request = *parsed;
  const std::string canonical =
      std::visit([](const auto& tiles) { return canonical_target(tiles); }, request);
  // The canonical form may be longer than any target may be.
  if (canonical.size() > kMaxTargetLength) return;
  const auto parsed_again = parse_tiles_target(*split_target(canonical), styles());
  require(bool{parsed_again}, "a canonical target is refused");
  const auto& again = *parsed_again;
  require(std::visit([](const auto& tiles) { return canonical_target(tiles); }, again) == canonical,
          "a canonical target has another canonical target");
  if (const auto* tile = std::get_if<TileRequest>(&request)) {
    check_plan(*tile, std::get<TileRequest>(again));
  }
}

void check_host(const std::string& host) {
  static const std::vector<std::string> allowed = {"maps.example", "*.tiles.example", "[::1]:8080"};
  if (!is_valid_host(host)) return;
  for (const char c : host) require(c > ' ' && c < 0x7f && c != '"' && c != '<', "a bad host");
  const bool is_allowed = is_allowed_host(host, allowed);
  require(!is_allowed || host.size() >= 10, "a host of nobody is allowed");
}

void check_address(const std::string& forwarded_for) {
  static const std::vector<AddressRange> trusted = {*parse_address_range("10.0.0.0/8"),
                                                    *parse_address_range("2001:db8::/32")};
  static const ClientAddress proxy = *parse_address("10.1.2.3");
  static const ClientAddress stranger = *parse_address("192.0.2.1");
  const ClientAddress client = client_behind(proxy, forwarded_for, trusted);
  require(parse_address(address_text(client)) == client, "an address is not its text");
  require(client_behind(stranger, forwarded_for, trusted) == stranger, "a stranger is believed");
  if (const auto range = parse_address_range(forwarded_for)) {
    require(range->contains(range->first), "a range is without its first address");
  }
}

void check(std::string_view text) {
  const Input input(text);
  check_decoding(input.target());
  check_tiles(input.target());
  check_host(input.host());
  matches_entity_tag(input.if_none_match(), "\"0123456789abcdef\"");
  check_address(input.forwarded_for());
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trapeze::check(trapeze::fuzzing::text_of(data, size));
  return 0;
}
