// Which features of a layer are drawn, and in which class: by the value of a property, by a filter,
// by ids.
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

/// The rules. Its field, values and filter fit the features of the layer that it was made for; with
/// a filter, these must outlive it.
/// Classes are numbered: those of the values or between the breaks, then that of all others, then
/// that of highlighted features.
struct Classing {
  int field = -1;  // number of the property that values or breaks are about; -1: none
  /// Values by which features can be classed and filtered beside their attributes; null: none.
  std::shared_ptr<const JoinedValues> joined;
  /// Class i is that of the value; null: of the features that have none.
  std::vector<std::optional<FilterLiteral>> values;
  /// The class that stands for class i of `values`: those that look alike are drawn as one.
  /// Empty: each for itself.
  std::vector<std::uint8_t> alike;
  std::vector<double> breaks;  // ascending; class i is that of the numbers below breaks[i]
  std::shared_ptr<const BoundFilter> filter;  // null: all pass
  std::vector<std::int64_t> ids;              // ascending; the only ones drawn; empty: all
  std::vector<std::int64_t> highlighted_ids;  // ascending

  std::size_t class_of_others() const;
  std::size_t class_of_highlighted() const { return class_of_others() + 1; }
  /// The same rules for the features of another table that has the same fields.
  Classing over(const FeatureTable& features) const;
  /// Whether all features are drawn, in one class.
  bool is_plain() const;
  /// Equal for rules that put the same features into the same classes.
  std::string key() const;
};

/// Applies the rules to one feature after the other. Refers to both, which must outlive it.
class FeatureClassifier {
 public:
  FeatureClassifier(const Classing& classing, const FeatureTable& features);

  /// The number of its class, or kNotDrawn.
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

/// Keeps the classes of the rules that were asked for last, within a budget of memory.
///
/// Thread-safety: any thread may call any function; a call of find() for classes that another
/// thread is computing waits for them.
class FeatureClassCache {
 public:
  /// `budget` in bytes; what alone is larger is made every time.
  explicit FeatureClassCache(std::size_t budget) : entries_(budget) {}

  /// `revision` tells the features of one layer from those of another, and from changed ones.
  std::shared_ptr<const FeatureClasses> find(std::uint64_t revision, const Classing& classing,
                                             const FeatureTable& features);
  /// Whether find() would have nothing to compute, nor to wait for.
  bool has(std::uint64_t revision, const Classing& classing);
  /// Bytes held.
  std::size_t memory() const;

 private:
  struct Entry {
    std::once_flag once;
    std::shared_ptr<const FeatureClasses> classes;
    std::atomic<bool> is_made = false;
  };

  std::shared_ptr<Entry> find_or_insert(const std::string& key, std::size_t bytes);

  mutable std::mutex mutex_;  // guards all below
  LruMap<std::string, std::shared_ptr<Entry>> entries_;
};

}  // namespace trapeze
