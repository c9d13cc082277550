// What services of the OGC are asked by key-value pairs: keys may be written in any case of
// letters.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/problem.h"
#include "server/base/result.h"
#include "server/base/url.h"

namespace trapeze {

/// The problem, with a code of the OGC and what it calls the parameter.
Problem ows_problem(int status, const char* code, std::string_view key, std::string detail,
                    std::string value = {});
Problem missing(std::string_view key, std::string_view takes);
Problem invalid(std::string_view key, std::string_view takes, const std::string& value,
                int status = 400);

/// A query, divided into the pairs of a service and others.
class KeyValuePairs {
 public:
  /// Without values. `keys` outlives the pairs.
  explicit KeyValuePairs(std::span<const std::string_view> keys)
      : keys_(keys), values_(keys.size()) {}

  /// The value of one of the keys, as they are written there; nothing if it was not given.
  const std::optional<std::string>& operator[](std::string_view key) const;
  std::optional<std::string>& at(std::string_view key);
  /// Whether it was given, and is not empty.
  bool has(std::string_view key) const { return (*this)[key] && !(*this)[key]->empty(); }

  std::vector<QueryPair> others;

 private:
  std::span<const std::string_view> keys_;
  std::vector<std::optional<std::string>> values_;
};

/// Other pairs that have no likeness to a parameter of styles are left out, as the standards want
/// it. The problem is a key that is given twice.
Result<KeyValuePairs> divide(std::span<const QueryPair> query,
                             std::span<const std::string_view> keys);

/// Of these pairs, those that are like a parameter of styles.
std::vector<QueryPair> style_pairs(std::span<const QueryPair> query);

/// In any case of letters.
bool is_equal(std::string_view a, std::string_view b);

/// What is wrong with a key that takes one value only.
std::optional<Problem> check(const KeyValuePairs& pairs, std::string_view key,
                             std::string_view value);

/// Between commas; an empty list has none.
std::vector<std::string_view> split_list(std::string_view list);

}  // namespace trapeze
