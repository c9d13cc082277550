// The values of a table joined to the features of a layer, by the attribute that is the key.
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
  /// Joins the rows whose key equals the attribute's value: texts must be equal byte by byte; for a
  /// numeric attribute, the numbers must be equal, however they are written. The problem, 400, is
  /// two keys that are the same number.
  static Result<std::shared_ptr<const JoinedValues>> join(std::shared_ptr<const ValueTable> table,
                                                          const Layer& layer, int field);

  const ValueTable& table() const { return *table_; }
  /// The value for the feature in that row of the layer; null if it has none.
  Value value(std::uint32_t row) const {
    const std::uint32_t of_table = rows_[row];
    return of_table == kNone ? Value() : table_->value(of_table);
  }
  /// Equal for joins of equal tables by the same attribute of one layer.
  const std::string& key() const { return key_; }
  static std::string key_of(const ValueTable& table, int field);

  std::size_t matched_rows() const { return table_->size() - unmatched_rows_; }
  /// The number of table rows whose key no feature has, and the first kMostNamed of their keys.
  std::size_t unmatched_rows() const { return unmatched_rows_; }
  const std::vector<std::string>& unmatched_keys() const { return unmatched_keys_; }
  /// The number of features whose key is not in the table.
  std::size_t unmatched_features() const { return unmatched_features_; }
  static constexpr std::size_t kMostNamed = 10;

  /// Of the numbers of all rows whose key a feature has, each row counted once.
  ValueSpread spread() const;
  /// In bytes, without the table.
  std::size_t memory() const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  std::shared_ptr<const ValueTable> table_;
  std::string key_;
  std::vector<std::uint32_t> rows_;  // of the table, by row of the layer
  std::vector<bool> is_matched_;     // by row of the table
  std::size_t unmatched_rows_ = 0;
  std::size_t unmatched_features_ = 0;
  std::vector<std::string> unmatched_keys_;
};

}  // namespace trapeze
