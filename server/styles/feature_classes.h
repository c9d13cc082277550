// Determines which features of a layer are drawn, and in which class: by the value of an attribute,
// by a filter, by ids.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/layer/class_dust.h"
#include "core/layer/feature_table.h"
#include "server/base/lru_map.h"
#include "server/styles/filter.h"
#include "server/values/attributes.h"

namespace trapeze {

/// The rules. Field, values and filter must fit the features of the layer that the rules were made
/// for; if there is a filter, the features must outlive the rules.
/// Classes are numbered: first those of the values or between the breaks, then the class of all
/// others, then that of highlighted features.
struct Classing {
  int field = -1;  // index of the attribute for values or breaks; -1: none
  /// Joined values, which can be used for classes and filters like attributes; null: none.
  std::shared_ptr<const JoinedValues> joined;
  /// Class i has value i; null: the features without a value.
  std::vector<std::optional<FilterLiteral>> values;
  /// The class that replaces class i of `values`: classes that look the same are drawn as one.
  /// Empty: no class is replaced.
  std::vector<std::uint8_t> alike;
  std::vector<double> breaks;                 // ascending; class i has the numbers below breaks[i]
  std::shared_ptr<const BoundFilter> filter;  // null: all features pass
  std::vector<std::int64_t> ids;              // ascending; only these are drawn; empty: all
  std::vector<std::int64_t> highlighted_ids;  // ascending

  std::size_t class_of_others() const;
  std::size_t class_of_highlighted() const { return class_of_others() + 1; }
  /// The same rules for the features of another table with the same fields.
  Classing over(const FeatureTable& features) const;
  /// Whether all features are drawn, in one class.
  bool is_plain() const;
  /// Equal for rules that put the same features into the same classes.
  std::string key() const;
};

/// Applies the rules to single features. Refers to both arguments, which must outlive it.
class FeatureClassifier {
 public:
  FeatureClassifier(const Classing& classing, const FeatureTable& features);

  /// The number of the feature's class, or kNotDrawn.
  std::uint8_t class_of(std::uint32_t row) const;

 private:
  std::uint8_t class_of_value(const Value& value) const;
  std::uint8_t class_of_index(std::size_t i) const;

  const Classing& classing_;
  const FeatureTable& features_;
  const Attributes attributes_;
  std::unordered_map<std::string_view, std::uint8_t> texts_;
};

/// The class of every feature, by row.
using FeatureClasses = std::vector<std::uint8_t>;
FeatureClasses classify(const Classing& classing, const FeatureTable& features);

/// Caches the classes of the most recently used rules, within a memory budget.
///
/// Thread-safety: any thread may call any function; a call of find() for classes that another
/// thread is computing waits for them.
class FeatureClassCache {
 public:
  /// `budget` is in bytes; classes larger than the budget are computed every time.
  explicit FeatureClassCache(std::size_t budget) : entries_(budget) {}

  /// `revision` identifies the features of a layer in a certain state.
  std::shared_ptr<const FeatureClasses> find(std::uint64_t revision, const Classing& classing,
                                             const FeatureTable& features);
  /// Whether find() has nothing to compute and no other thread to wait for.
  bool has(std::uint64_t revision, const Classing& classing);
  /// Memory in bytes.
  std::size_t memory() const;

 private:
  struct Entry {
    std::once_flag once;
    std::shared_ptr<const FeatureClasses> classes;
    std::atomic<bool> is_made = false;
  };

  std::shared_ptr<Entry> find_or_insert(const std::string& key, std::size_t bytes);

  mutable std::mutex mutex_;  // guards everything below
  LruMap<std::string, std::shared_ptr<Entry>> entries_;
};

}  // namespace trapeze
