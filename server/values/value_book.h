// Posted tables by id, within a memory budget.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "server/base/lru_map.h"
#include "server/base/result.h"
#include "server/values/value_table.h"

namespace trapeze {

/// A table of the configuration.
struct NamedTable {
  std::shared_ptr<const ValueTable> table;
  std::string title;        // of its values, for people
  std::string attribution;  // attribution required on maps that use the values
  /// The same values in other languages, by language tag: used for labels.
  std::map<std::string, std::shared_ptr<const ValueTable>, std::less<>> languages = {};
};
using NamedTables = std::map<std::string, NamedTable, std::less<>>;

class ValueBook {
 public:
  /// `budget` is in bytes; the least recently used tables are removed first.
  explicit ValueBook(std::size_t budget) : posted_(budget) {}

  /// Stores the table under its id, and returns the stored table. The problem, 403 or 413, is a
  /// table larger than the budget.
  Result<std::shared_ptr<const ValueTable>> post(ValueTable table);

  /// Null if there is no table with that id.
  std::shared_ptr<const ValueTable> find(const std::string& id) const;
  /// Memory in bytes.
  std::size_t memory() const;

 private:
  mutable std::mutex mutex_;  // guards posted_
  mutable LruMap<std::string, std::shared_ptr<const ValueTable>> posted_;
};

}  // namespace trapeze
