// The values of a table as features of a layer have them: by the attribute that is the key.
//
// Thread-safety: immutable, any number of threads may read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/layer/layer.h"
#include "server/base/result.h"
#include "server/values/value_spread.h"
#include "server/values/value_table.h"

namespace trapeze {

class JoinedValues {
 public:
  /// Joins the rows whose key is the value of that attribute: the same text, byte by byte; of an
  /// attribute of numbers, the same number, however it is written. The problem, 400, is two keys
  /// that are the same number.
  static Result<std::shared_ptr<const JoinedValues>> join(std::shared_ptr<const ValueTable> table,
                                                          const Layer& layer, int field);

  const ValueTable& table() const { return *table_; }
  /// Of the feature in that row of the layer; null where it has none.
  Value value(std::uint32_t row) const {
    const std::uint32_t of_table = rows_[row];
    return of_table == kNone ? Value() : table_->value(of_table);
  }
  /// Equal for joins of equal tables by the same attribute of one layer.
  const std::string& key() const { return key_; }
  static std::string key_of(const ValueTable& table, int field);

  std::size_t matched_rows() const { return table_->size() - unmatched_rows_; }
  /// Rows of the table that no feature has the key of, and the first kMostNamed of their keys.
  std::size_t unmatched_rows() const { return unmatched_rows_; }
  const std::vector<std::string>& unmatched_keys() const { return unmatched_keys_; }
  /// Features whose key has no row.
  std::size_t unmatched_features() const { return unmatched_features_; }
  static constexpr std::size_t kMostNamed = 10;

  /// Of the numbers of all rows that a feature has the key of, each once.
  ValueSpread spread() const;
  /// In bytes, without the table.
  std::size_t memory() const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  std::shared_ptr<const ValueTable> table_;
  std::string key_;
  std::vector<std::uint32_t> rows_;  // of the table, by those of the layer
  std::vector<bool> is_matched_;     // by rows of the table
  std::size_t unmatched_rows_ = 0;
  std::size_t unmatched_features_ = 0;
  std::vector<std::string> unmatched_keys_;
};

}  // namespace trapeze
