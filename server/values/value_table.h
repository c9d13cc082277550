// A table of keys and values to be joined to the features of layers: numbers or words, each with a
// unique key.
//
// Thread-safety: immutable, any number of threads may read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/layer/feature_table.h"
#include "server/base/result.h"

namespace trapeze {

/// Names of the columns.
struct ValueNames {
  std::string key;
  std::string value;
};

class ValueTable {
 public:
  /// 40 hex digits that depend on names and rows: equal tables have equal ids, on every server.
  const std::string& id() const { return id_; }
  const ValueNames& names() const { return names_; }
  std::size_t size() const { return rows_.size(); }
  /// The type of the values: integers, numbers or words.
  FieldType type() const { return type_; }
  /// The number of rows without a value.
  std::size_t missing() const { return missing_; }
  /// The number of rows of the source that had a value but no key, and were therefore left out.
  std::size_t without_key() const { return without_key_; }
  /// Whether "1,5" is a number among the keys.
  bool has_decimal_commas() const { return has_decimal_commas_; }
  /// If the values are words: the first one that is not a number.
  const std::string& first_word() const { return first_word_; }

  /// `row` < size(). The results are views into the table.
  std::string_view key(std::uint32_t row) const;
  Value value(std::uint32_t row) const;
  /// The row with exactly that key, byte by byte.
  std::optional<std::uint32_t> find(std::string_view key) const;
  /// In bytes.
  std::size_t memory() const;

 private:
  friend class ValueTableBuilder;

  struct Row {
    std::uint32_t begin = 0;  // of its key in the text; a word follows its key
    std::uint16_t key_size = 0;
    std::uint16_t value_size = 0;  // for words, and before the type is known
  };

  std::string id_;
  ValueNames names_;
  FieldType type_ = FieldType::text;
  std::size_t missing_ = 0;
  std::size_t without_key_ = 0;
  bool has_decimal_commas_ = false;
  std::string first_word_;
  std::string text_;
  std::vector<Row> rows_;
  std::vector<std::uint64_t> numbers_;  // by row, for numeric values: the bits of doubles
  std::vector<bool> has_value_;         // by row
  std::vector<std::uint32_t> slots_;    // open addressing over rows, by a hash of the key
};

/// Builds a table row by row. One thread at a time.
class ValueTableBuilder {
 public:
  /// Rows beyond `max_rows` are refused. With `has_decimal_commas`, "1,5" is a number.
  ValueTableBuilder(ValueNames names, std::size_t max_rows, bool has_decimal_commas = false);

  /// For a source that names the values only after some rows without any.
  void name_values(std::string name) { table_.names_.value = std::move(name); }
  /// Reserves memory for that many rows and bytes of text in them.
  void reserve(std::size_t rows, std::size_t bytes);
  /// `place` identifies the row for people, such as 7 for "line 7". Spaces around key and value are
  /// ignored. The problem, 400 or 413, is a row that cannot be added.
  std::optional<Problem> add(std::string_view key, std::string_view value, std::size_t place);

  /// The finished table. The problem, 400, concerns the whole table: duplicate keys, infinite
  /// numbers, no rows.
  Result<ValueTable> finish() &&;

  static constexpr std::size_t kMaxTextBytes = 256;  // of a key or a word

 private:
  bool insert(std::string_view key, std::uint32_t row);
  void grow_slots(std::size_t rows);
  std::optional<Problem> find_type();
  std::string_view text_of_value(std::uint32_t row) const;
  void give_up_text();
  std::string identity() const;

  ValueTable table_;
  const std::size_t max_rows_;
  const bool has_decimal_commas_;
  std::vector<std::uint32_t> places_;  // by row
  std::size_t doubles_ = 0;
  std::string double_keys_;  // the first ones, as part of a sentence
};

}  // namespace trapeze
