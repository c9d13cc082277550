#include "server/documents/value_tables.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "server/base/json_text.h"
#include "server/data/layer_summary.h"
#include "server/documents/catalog.h"
#include "server/styles/colour_ramps.h"
#include "server/styles/filter.h"
#include "server/styles/style_parameters.h"

namespace trapeze {
namespace {

Json summary_json(std::string_view id, const ValueTable& table) {
  Json json;
  json["id"] = id;
  json["rows"] = table.size();
  json["key"] = table.names().key;
  json["value"] = table.names().value;
  json["type"] = json_type_of(table.type());
  json["missing"] = table.missing();
  if (table.without_key() > 0) json["rows_without_key"] = table.without_key();
  if (!table.first_word().empty()) json["first_word"] = table.first_word();
  return json;
}

/// A class for each of the most frequent words that are short enough for a URL, in the format of
/// `classes`; empty if there are none.
std::string example_classes(const ValueTable& table) {
  constexpr std::size_t kMaxClasses = 8;
  constexpr std::size_t kMaxWord = 40;  // bytes
  std::map<std::string_view, std::size_t> counts;
  for (std::uint32_t row = 0; row < table.size(); ++row) {
    const Value value = table.value(row);
    const auto* word = std::get_if<std::string_view>(&value);
    if (word != nullptr && word->size() <= kMaxWord && !has_control_character(*word)) {
      ++counts[*word];
    }
  }
  std::vector<std::pair<std::string_view, std::size_t>> commonest(counts.begin(), counts.end());
  std::ranges::stable_sort(commonest, std::greater(), &decltype(commonest)::value_type::second);
  commonest.resize(std::min(commonest.size(), kMaxClasses));
  if (commonest.empty()) return {};
  const std::vector<Rgba> colours = ramp_colours("Set2", commonest.size()).value();
  std::vector<ColourClass> classes;
  for (std::size_t i = 0; i < commonest.size(); ++i) {
    classes.push_back({ColourClass::Kind::value, std::string(commonest[i].first), colours[i]});
  }
  return format_value(classes);
}

/// As in a URL, without the '?'.
std::string example_query(std::string_view id, const ValueTable& table, const std::string& join) {
  const std::string query = fmt::format("values={}&join={}", id, percent_encode(join));
  if (table.type() != FieldType::text) {
    return query + "&color-by=value&breaks=quantile:5&ramp=YlGnBu";
  }
  const std::string classes = example_classes(table);
  if (classes.empty()) return query;
  return fmt::format("{}&color-by=value&classes={}", query, percent_encode(classes));
}

Result<Json> join_json(std::string_view id, const std::shared_ptr<const ValueTable>& table,
                       const ServedLayer& served, int field, const std::string& base_url) {
  const auto joined = served.derived->join(served.revision, *served.layer, field, table);
  if (!joined) return joined.problem();
  const JoinedValues& values = **joined;
  const std::string& attribute =
      served.layer->features().fields()[static_cast<std::size_t>(field)].name;
  return Json{{"layer", served.config.name},
              {"join", attribute},
              {"matched", values.matched_rows()},
              {"unmatched", values.unmatched_rows()},
              {"unmatched_keys", values.unmatched_keys()},
              {"features_without_value", values.unmatched_features()},
              {"tiles", fmt::format("{}/tiles/{}/{{z}}/{{x}}/{{y}}.png?{}", base_url,
                                    served.config.name, example_query(id, *table, attribute))}};
}

/// For the requested layer, or for all layers with an attribute to join by.
Result<Json> joins_json(std::string_view id, const std::shared_ptr<const ValueTable>& table,
                        const TableQuery& query, const Dataset& dataset,
                        const std::string& base_url) {
  const std::string& join = query.join.empty() ? table->names().key : query.join;
  if (query.layer && !dataset.find(*query.layer)) return unknown_layer(*query.layer, dataset);
  Json joins = Json::array();
  for (const ServedLayer& served : dataset.layers()) {
    if (query.layer && served.config.name != *query.layer) continue;
    if (served.parts != nullptr) {
      if (!query.layer) continue;
      return Problem{
          400,
          fmt::format("The layer {} is in several parts, to which values cannot be joined.",
                      served.config.name),
          "layer", served.config.name, "a layer in one piece"};
    }
    const int field = served.layer->features().field_index(join);
    if (field < 0 && query.layer && !query.join.empty()) {
      return unknown_property("join", join, served.layer->features());
    }
    if (field < 0) continue;
    auto json = join_json(id, table, served, field, base_url);
    if (json) {
      joins.push_back(*std::move(json));
    } else if (query.layer) {
      return std::move(json).problem();
    }
  }
  return joins;
}

Json languages_of(const NamedTable& named) {
  Json tags = Json::array();
  for (const auto& [tag, table] : named.languages) tags.push_back(tag);
  return tags;
}

Document named_tables_document(const NamedTables& tables) {
  Json list = Json::array();
  for (const auto& [name, named] : tables) {
    Json json = summary_json(name, *named.table);
    json["title"] = named.title;
    json["attribution"] = named.attribution;
    if (!named.languages.empty()) json["languages"] = languages_of(named);
    list.push_back(std::move(json));
  }
  return {"application/json", to_text({{"tables", std::move(list)}})};
}

}  // namespace

Result<TableQuery> parse_table_query(const std::vector<QueryPair>& query) {
  TableQuery parsed;
  std::vector<std::string_view> seen;
  for (const auto& [name, value] : query) {
    if (name == kFreeParameter) continue;
    if (std::ranges::find(seen, name) != seen.end()) {
      return Problem{400, fmt::format("The parameter {} is given more than once.", name), name,
                     value, "one value, once"};
    }
    seen.push_back(name);
    if (name == "key") {
      parsed.columns.key = value;
    } else if (name == "value") {
      parsed.columns.value = value;
    } else if (name == "layer") {
      parsed.layer = value;
    } else if (name == "join") {
      parsed.join = value;
    } else {
      return Problem{400, fmt::format("There is no parameter \"{}\" of a table.", name), name,
                     value, "one of key, value, layer, join"};
    }
  }
  return parsed;
}

Result<Document> table_document(std::string_view id, const std::shared_ptr<const ValueTable>& table,
                                const TableQuery& query, const Dataset& dataset,
                                const std::string& base_url) {
  auto joins = joins_json(id, table, query, dataset, base_url);
  if (!joins) return std::move(joins).problem();
  Json json = summary_json(id, *table);
  json["joins"] = *std::move(joins);
  return Document{"application/json", to_text(json)};
}

Result<Document> value_tables_document(const DocumentRequest& request) {
  const NamedTables& named = request.dataset.tables();
  if (request.path.size() == 1) return named_tables_document(named);
  const auto query = parse_table_query(request.query);
  if (!query) return query.problem();
  const std::string& id = request.path[1];
  const auto found = named.find(id);
  const auto table = found == named.end() ? request.styles.find_table(id) : found->second.table;
  if (table == nullptr) {
    return Problem{404,
                   "There is no table of that name. Posted tables expire when memory is needed: "
                   "post it again."};
  }
  return table_document(id, table, *query, request.dataset, request.base_url);
}

}  // namespace trapeze
