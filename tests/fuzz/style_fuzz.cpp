// Bodies of POST /styles: each is refused with a message, or is a style whose document, query and
// id lead back to the same style.
//
// Input: the body.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/url.h"
#include "server/styles/style_book.h"
#include "server/styles/style_document.h"
#include "server/styles/style_parameters.h"
#include "tests/fuzz/require.h"

namespace trapeze {
namespace {

using fuzzing::require;

std::vector<std::string> layers_of(const StyleQuery& style) {
  std::vector<std::string> layers;
  for (const StyleSetting& setting : style.settings()) {
    if (!setting.layer.empty() && std::ranges::find(layers, setting.layer) == layers.end()) {
      layers.push_back(setting.layer);
    }
  }
  return layers;
}

void check_order(const StyleQuery& style) {
  const auto settings = style.settings();
  for (std::size_t i = 1; i < settings.size(); ++i) {
    require(std::tie(settings[i - 1].layer, settings[i - 1].parameter) <
                std::tie(settings[i].layer, settings[i].parameter),
            "settings are not in order, each once");
  }
}

void check_document(const StyleQuery& style) {
  const auto again = parse_style_document(style_document(style));
  require(bool{again}, "the document of a style is refused");
  require(again->canonical_text() == style.canonical_text(),
          "the document of a style is another style");
}

void check_query(const StyleQuery& style) {
  const auto pairs = decode_query(style.canonical_text());
  // A URL cannot contain control characters, so neither can a posted style.
  require(pairs.has_value(), "the query of a style cannot be decoded");
  const auto again = StyleQuery::parse(*pairs, layers_of(style));
  require(bool{again}, "the query of a style is refused");
  require(again->canonical_text() == style.canonical_text(),
          "the query of a style is another style");
}

void check_id(const StyleQuery& style) {
  StyleBook book;
  const auto id = book.post(style);
  if (!id) {
    require(id.problem().status == 400, "a style is refused, but not with 400");
    return;
  }
  const auto styled = book.read({{"style", *id}});
  require(static_cast<bool>(styled), "a posted style is unknown");
  const auto named = styled->style_for(layers_of(style));
  require(named && named->pairs() == style.pairs(), "a posted style differs");
}

/// The settings of one layer as in a configuration: for all layers, without its name.
StyleQuery settings_of(const StyleQuery& style, const std::string& layer) {
  std::vector<QueryPair> pairs;
  for (const StyleSetting& setting : style.settings()) {
    if (setting.layer != layer) continue;
    pairs.emplace_back(style_parameter(setting.parameter).name, format_value(setting.value));
  }
  const auto settings = StyleQuery::parse(pairs, {});
  require(bool{settings}, "settings of a layer are none for all");
  return *settings;
}

void check_defaults(const StyleQuery& style) {
  const std::vector<std::string> layers = layers_of(style);
  for (const std::string& layer : layers) {
    for (const std::string& source : layers) {
      const StyleQuery full = style.with_defaults(layer, settings_of(style, source));
      check_order(full);
      for (const StyleSetting& setting : style.settings()) {
        if (setting.layer != layer) continue;
        require(format_value(*full.find(layer, setting.parameter)) == format_value(setting.value),
                "a default overrides what is set");
      }
    }
  }
}

void check(std::string_view text) {
  const auto parsed = parse_style_document(text);
  if (!parsed) {
    require(parsed.problem().status == 400, "a document is refused, but not with 400");
    require(!parsed.problem().detail.empty() && !problem_json(parsed.problem()).empty(),
            "a problem without words");
    return;
  }
  const auto& style = *parsed;
  check_order(style);
  check_document(style);
  check_query(style);
  check_id(style);
  check_defaults(style);
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trapeze::check(trapeze::fuzzing::text_of(data, size));
  return 0;
}
