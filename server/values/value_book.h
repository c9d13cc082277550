// Tables that were posted, by their ids, within a budget of memory.
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

/// Tables of the configuration, by their names.
struct NamedTable {
  std::shared_ptr<const ValueTable> table;
  std::string title;        // what its values are, for people
  std::string attribution;  // what maps must say about where they are from
  /// The same values in other languages, by their tags: what labels say in them.
  std::map<std::string, std::shared_ptr<const ValueTable>, std::less<>> languages = {};
};
using NamedTables = std::map<std::string, NamedTable, std::less<>>;

class ValueBook {
 public:
  /// `budget` in bytes: of the tables, those not asked for longest go first.
  explicit ValueBook(std::size_t budget) : posted_(budget) {}

  /// Keeps the table under its id, and answers with it as it is kept. The problem, 403 or 413, is
  /// one that is larger than the budget.
  Result<std::shared_ptr<const ValueTable>> post(ValueTable table);

  /// Null if there is none of that id.
  std::shared_ptr<const ValueTable> find(const std::string& id) const;
  /// Bytes held.
  std::size_t memory() const;

 private:
  mutable std::mutex mutex_;  // guards posted_
  mutable LruMap<std::string, std::shared_ptr<const ValueTable>> posted_;
};

}  // namespace trapeze
