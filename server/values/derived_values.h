// What was found out about layers for styles, kept so that no tile waits for it twice: joined
// values, how numbers are spread, and where they are parted into classes.
//
// Thread-safety: all methods may be called from any thread; a call for what another thread is
// finding out waits for it.
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
  /// `budget` in bytes, for the last that were asked for.
  explicit DerivedValues(std::size_t budget = kDefaultBudget) : kept_(budget) {}

  /// As JoinedValues::join(). `revision` tells the layer from others, and from what it was.
  Result<std::shared_ptr<const JoinedValues>> join(std::uint64_t revision, const Layer& layer,
                                                   int field,
                                                   const std::shared_ptr<const ValueTable>& table);
  /// Whether join() has its answer already.
  bool has_join(std::uint64_t revision, int field, const ValueTable& table) const;

  /// Of an attribute of numbers.
  std::shared_ptr<const ValueSpread> spread(std::uint64_t revision, const Layer& layer, int field);
  /// Of joined values that are numbers.
  std::shared_ptr<const ValueSpread> spread(std::uint64_t revision, const JoinedValues& joined);

  /// class_breaks() of what spread() gives.
  std::vector<double> breaks(std::uint64_t revision, const Layer& layer, int field,
                             const BreakRule& rule);
  std::vector<double> breaks(std::uint64_t revision, const JoinedValues& joined,
                             const BreakRule& rule);

  /// Whether breaks() has its answer already: of an attribute, of values joined by an attribute.
  bool has_breaks(std::uint64_t revision, int field, const BreakRule& rule) const;
  bool has_breaks(std::uint64_t revision, const ValueTable& table, int joined_by,
                  const BreakRule& rule) const;

  /// Bytes held, about.
  std::size_t memory() const;

  static constexpr std::size_t kDefaultBudget = std::size_t{128} << 20;

 private:
  struct Entry {
    std::once_flag once;
    std::shared_ptr<const Result<std::shared_ptr<const JoinedValues>>> joined;
    std::shared_ptr<const ValueSpread> spread;
    std::vector<double> breaks;
  };

  /// What is kept under that key, found out by `find` if it is not there yet.
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
