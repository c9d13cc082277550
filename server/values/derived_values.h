// Caches what was computed about layers for styles, so that no tile waits for it twice: joined
// values, the distribution of numbers, and class breaks.
//
// Thread-safety: all methods may be called from any thread; a call for something that another
// thread is computing waits for it.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/layer/layer.h"
#include "server/base/lru_map.h"
#include "server/base/result.h"
#include "server/values/class_breaks.h"
#include "server/values/joined_values.h"
#include "server/values/value_spread.h"
#include "server/values/value_table.h"

namespace trapeze {

class DerivedValues {
 public:
  /// `budget` is in bytes; the most recently used results are kept.
  explicit DerivedValues(std::size_t budget = kDefaultBudget) : kept_(budget) {}

  /// See JoinedValues::join(). `revision` identifies the layer in a certain state.
  Result<std::shared_ptr<const JoinedValues>> join(std::uint64_t revision, const Layer& layer,
                                                   int field,
                                                   const std::shared_ptr<const ValueTable>& table);
  /// Whether the result of join() is cached.
  bool has_join(std::uint64_t revision, int field, const ValueTable& table) const;

  /// For a numeric attribute.
  std::shared_ptr<const ValueSpread> spread(std::uint64_t revision, const Layer& layer, int field);
  /// For numeric joined values.
  std::shared_ptr<const ValueSpread> spread(std::uint64_t revision, const JoinedValues& joined);

  /// class_breaks() of the result of spread().
  std::vector<double> breaks(std::uint64_t revision, const Layer& layer, int field,
                             const BreakRule& rule);
  std::vector<double> breaks(std::uint64_t revision, const JoinedValues& joined,
                             const BreakRule& rule);

  /// Whether the result of breaks() is cached: for an attribute, and for values joined by an
  /// attribute.
  bool has_breaks(std::uint64_t revision, int field, const BreakRule& rule) const;
  bool has_breaks(std::uint64_t revision, const ValueTable& table, int joined_by,
                  const BreakRule& rule) const;

  /// Approximate memory in bytes.
  std::size_t memory() const;

  static constexpr std::size_t kDefaultBudget = std::size_t{128} << 20;

 private:
  struct Entry {
    std::once_flag once;
    std::shared_ptr<const Result<std::shared_ptr<const JoinedValues>>> joined;
    std::shared_ptr<const ValueSpread> spread;
    std::vector<double> breaks;
  };

  /// The entry with that key; `find` computes it if it is missing.
  std::shared_ptr<Entry> keep(const std::string& key, std::size_t bytes,
                              const std::function<void(Entry&)>& find);
  bool has(const std::string& key) const;
  std::vector<double> keep_breaks(
      const std::string& key, const BreakRule& rule,
      const std::function<std::shared_ptr<const ValueSpread>()>& spread);

  mutable std::mutex mutex_;  // guards kept_
  mutable LruMap<std::string, std::shared_ptr<Entry>> kept_;
};

}  // namespace trapeze
