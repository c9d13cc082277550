// Key-value pairs in requests to OGC services; keys ignore case.
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

/// The problem, with an OGC code and the parameter name that OGC uses.
Problem ows_problem(int status, const char* code, std::string_view key, std::string detail,
                    std::string value = {});
Problem missing(std::string_view key, std::string_view takes);
Problem invalid(std::string_view key, std::string_view takes, const std::string& value,
                int status = 400);

/// A query, divided into the pairs of a service and others.
class KeyValuePairs {
 public:
  /// Starts without values. `keys` must outlive the pairs.
  explicit KeyValuePairs(std::span<const std::string_view> keys)
      : keys_(keys), values_(keys.size()) {}

  /// The value of a key, spelled as in `keys`; nothing if it was not given.
  const std::optional<std::string>& operator[](std::string_view key) const;
  std::optional<std::string>& at(std::string_view key);
  /// Whether the key was given and is not empty.
  bool has(std::string_view key) const { return (*this)[key] && !(*this)[key]->empty(); }

  std::vector<QueryPair> others;

 private:
  std::span<const std::string_view> keys_;
  std::vector<std::optional<std::string>> values_;
};

/// Other pairs that do not resemble a style parameter are ignored, as the standards require. The
/// problem is a key that is given twice.
Result<KeyValuePairs> divide(std::span<const QueryPair> query,
                             std::span<const std::string_view> keys);

/// The pairs that resemble a style parameter.
std::vector<QueryPair> style_pairs(std::span<const QueryPair> query);

/// Ignores case.
bool is_equal(std::string_view a, std::string_view b);

/// The problem of a key that does not have its only allowed value.
std::optional<Problem> check(const KeyValuePairs& pairs, std::string_view key,
                             std::string_view value);

/// Splits at commas; an empty list has no items.
std::vector<std::string_view> split_list(std::string_view list);

}  // namespace trapeze
