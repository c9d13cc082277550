#include "server/documents/classification.h"

#include <spdlog/fmt/fmt.h>

#include <utility>

namespace trapeze {
namespace {

Json join_json(const JoinedValues& joined, const std::string& attribute) {
  return {{"values", joined.table().id()},
          {"join", attribute},
          {"matched", joined.matched_rows()},
          {"unmatched", joined.unmatched_rows()},
          {"unmatched_keys", joined.unmatched_keys()},
          {"features_without_value", joined.unmatched_features()}};
}

std::size_t class_count(const Classing& classing, const ValueSpread& spread) {
  if (spread.is_empty()) return 0;
  return spread.least() == spread.greatest() ? 1 : classing.breaks.size() + 1;
}

/// Why there are fewer classes than requested; empty if there are not.
std::string why_fewer(const BreakRule& rule, std::size_t classes, const ValueSpread& spread) {
  const bool is_exact = rule.method != BreakMethod::stddev && rule.method != BreakMethod::pretty;
  if (!is_exact || classes >= static_cast<std::size_t>(rule.classes)) return {};
  if (spread.is_empty()) return "There are no numbers to classify.";
  return fmt::format("There are {} classes instead of {}, because many values are equal.", classes,
                     rule.classes);
}

}  // namespace

Json classification_json(const LayerStyle& style) {
  const Classing& classing = style.classing;
  const auto& origin = style.origin;
  Json json;
  if (origin && (origin->rule || !classing.breaks.empty())) {
    json["attribute"] = origin->attribute;
    if (origin->rule) json["method"] = break_rule_text(*origin->rule);
    json["breaks"] = classing.breaks;
    if (const ValueSpread* spread = origin->spread.get()) {
      json["min"] = spread->is_empty() ? Json(nullptr) : Json(spread->least());
      json["max"] = spread->is_empty() ? Json(nullptr) : Json(spread->greatest());
      json["count"] = spread->count;
      json["missing"] = spread->missing;
      if (origin->rule) {
        const std::size_t classes = class_count(classing, *spread);
        // A single class is drawn as the one above a break with nothing below it.
        if (classes == 1) json["breaks"] = Json::array();
        json["classes"] = classes;
        const std::string why = why_fewer(*origin->rule, classes, *spread);
        if (!why.empty()) json["note"] = why;
      }
    }
  }
  if (classing.joined != nullptr) json["join"] = join_json(*classing.joined, style.join_attribute);
  return json;
}

}  // namespace trapeze
