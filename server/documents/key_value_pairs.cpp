#include "server/documents/key_value_pairs.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "server/base/nearest_name.h"
#include "server/documents/ows_exception.h"
#include "server/styles/style_parameters.h"

namespace trapeze {
namespace {

bool is_like_a_style_parameter(const std::string& name) {
  const std::string_view parameter = std::string_view(name).substr(name.rfind('.') + 1);
  if (parameter == kFreeParameter) return true;
  std::vector<std::string> known;
  for (const StyleParameter& style : style_parameters()) known.emplace_back(style.name);
  return nearest_name(parameter, known).has_value();
}

std::size_t place_of(std::string_view key, std::span<const std::string_view> keys) {
  return static_cast<std::size_t>(std::ranges::find(keys, key) - keys.begin());
}

}  // namespace

const std::optional<std::string>& KeyValuePairs::operator[](std::string_view key) const {
  return values_[place_of(key, keys_)];
}

std::optional<std::string>& KeyValuePairs::at(std::string_view key) {
  return values_[place_of(key, keys_)];
}

Problem ows_problem(int status, const char* code, std::string_view key, std::string detail,
                    std::string value) {
  Problem problem{status, std::move(detail), std::string(key), std::move(value), {}};
  problem.code = code;
  return problem;
}

Problem missing(std::string_view key, std::string_view takes) {
  return ows_problem(400, ows::kMissingParameterValue, key,
                     fmt::format("{} is missing. It takes {}.", key, takes));
}

Problem invalid(std::string_view key, std::string_view takes, const std::string& value,
                int status) {
  return ows_problem(status, ows::kInvalidParameterValue, key,
                     fmt::format("{} takes {}.", key, takes), value);
}

std::vector<QueryPair> style_pairs(std::span<const QueryPair> query) {
  std::vector<QueryPair> pairs;
  for (const QueryPair& pair : query) {
    if (is_like_a_style_parameter(pair.first)) pairs.push_back(pair);
  }
  return pairs;
}

Result<KeyValuePairs> divide(std::span<const QueryPair> query,
                             std::span<const std::string_view> keys) {
  KeyValuePairs pairs(keys);
  std::vector<QueryPair> others;
  for (const auto& [name, value] : query) {
    const std::string lower = in_lower_case(name);
    const auto key = std::ranges::find_if(keys, [&lower](std::string_view known) {
      return in_lower_case(std::string(known)) == lower;
    });
    if (key == keys.end()) {
      others.emplace_back(name, value);
      continue;
    }
    std::optional<std::string>& place = pairs.at(*key);
    if (place) return invalid(*key, "one value, once", value);
    place = value;
  }
  pairs.others = style_pairs(others);
  return pairs;
}

bool is_equal(std::string_view a, std::string_view b) {
  return in_lower_case(a) == in_lower_case(b);
}

/// For a key with a single allowed value.
std::optional<Problem> check(const KeyValuePairs& pairs, std::string_view key,
                             std::string_view value) {
  const auto& given = pairs[key];
  if (!given || given->empty()) return missing(key, value);
  if (!is_equal(*given, value)) return invalid(key, value, *given);
  return std::nullopt;
}

std::vector<std::string_view> split_list(std::string_view list) {
  std::vector<std::string_view> items;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    items.push_back(list.substr(0, comma));
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return items;
}

}  // namespace trapeze
