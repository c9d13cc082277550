// A table of keys and values, to be joined to the features of layers: numbers or words, by a key
// that each row has for itself.
//
// Thread-safety: immutable, any number of threads may read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/layer/feature_table.h"
#include "server/base/result.h"

namespace trapeze {

/// How columns are called.
struct ValueNames {
  std::string key;
  std::string value;
};

class ValueTable {
 public:
  /// 40 hex digits, of names and rows: equal tables have equal ids, on every server.
  const std::string& id() const { return id_; }
  const ValueNames& names() const { return names_; }
  std::size_t size() const { return rows_.size(); }
  /// Of the values: integers, numbers or words.
  FieldType type() const { return type_; }
  /// Rows without a value.
  std::size_t missing() const { return missing_; }
  /// Rows of the source that had a value and no key, and so are not here.
  std::size_t without_key() const { return without_key_; }
  /// Where the values are words: the first that is no number.
  const std::string& first_word() const { return first_word_; }

  /// `row` < size(). Views of memory of the table.
  std::string_view key(std::uint32_t row) const;
  Value value(std::uint32_t row) const;
  /// The row of that key, byte by byte the same.
  std::optional<std::uint32_t> find(std::string_view key) const;
  /// In bytes.
  std::size_t memory() const;

 private:
  friend class ValueTableBuilder;

  struct Row {
    std::uint32_t begin = 0;  // of its key in the text; the value of words follows it
    std::uint16_t key_size = 0;
    std::uint16_t value_size = 0;  // of words, and before their type is known
  };

  std::string id_;
  ValueNames names_;
  FieldType type_ = FieldType::text;
  std::size_t missing_ = 0;
  std::size_t without_key_ = 0;
  std::string first_word_;
  std::string text_;
  std::vector<Row> rows_;
  std::vector<std::uint64_t> numbers_;  // by row, of a table of numbers; the bits of doubles
  std::vector<bool> has_value_;         // by row
  std::vector<std::uint32_t> slots_;    // open addressing over rows, by a hash of the keys
};

/// Takes rows one by one. One thread at a time.
class ValueTableBuilder {
 public:
  /// Rows beyond `max_rows` are refused. With `has_decimal_commas`, "1,5" is a number.
  ValueTableBuilder(ValueNames names, std::size_t max_rows, bool has_decimal_commas = false);

  /// For so many rows, and bytes of text in them, there is room at once.
  void reserve(std::size_t rows, std::size_t bytes);
  /// `place` tells people where the row is, such as "line 7"'s 7. Blanks around both do not count.
  /// The problem, 400 or 413, is a row that cannot be taken.
  std::optional<Problem> add(std::string_view key, std::string_view value, std::size_t place);

  /// The table. The problem, 400, is what is wrong with all of it: keys that come twice, numbers
  /// without end, no rows.
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
  std::string double_keys_;  // the first of them, for a sentence
};

}  // namespace trapeze
