// Ids and attributes of the features of a layer, by row. The geometry is stored elsewhere, under
// the same row.
//
// Thread-safety: immutable once filled; any number of threads may read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/grid/stored_array.h"

namespace trapeze {

/// Throws std::invalid_argument with these words if the condition does not hold.
inline void require_valid(bool condition, const char* words) {
  if (!condition) throw std::invalid_argument(words);
}

enum class FieldType : std::uint8_t { integer, real, text };

struct Field {
  std::string name;
  FieldType type = FieldType::text;
};

/// Null is std::monostate. The string is a view of memory of the table.
using Value = std::variant<std::monostate, std::int64_t, double, std::string_view>;

class FeatureTable {
 public:
  /// The cells as flat arrays, which can be stored and viewed again.
  struct Cells {
    struct Column {
      std::span<const std::uint64_t> numbers;
      std::span<const std::uint64_t> nulls;
      std::span<const std::uint32_t> texts;
    };
    std::span<const std::int64_t> ids;
    std::vector<Column> columns;
    std::span<const char> string_bytes;
    std::span<const std::uint64_t> string_ends;
  };

  FeatureTable() = default;
  explicit FeatureTable(std::vector<Field> fields);
  /// A table that is a view of cells, which must outlive it. Throws std::invalid_argument if their
  /// sizes do not match each other or the fields, so no value is ever read from beyond them.
  FeatureTable(std::vector<Field> fields, const Cells& cells);

  /// Appends a row and returns its number. There are as many `values` as fields, each null or of
  /// its field's type; throws std::invalid_argument otherwise. `id` is the feature id of the
  /// source.
  std::uint32_t append(std::int64_t id, std::span<const Value> values);

  /// Replaces the values of a row; otherwise like append().
  void replace(std::uint32_t row, std::span<const Value> values);

  /// An independent, mutable copy of this table.
  FeatureTable copy() const;

  /// Releases memory that only appending needs.
  void shrink_to_fit();

  std::size_t size() const { return ids_.size(); }
  std::span<const Field> fields() const { return fields_; }
  /// Number of the first field of that name, or -1.
  int field_index(std::string_view name) const;
  std::int64_t id(std::uint32_t row) const { return ids_[row]; }
  /// Preconditions: `row` < size(), 0 <= `field` < fields().size().
  Value value(std::uint32_t row, int field) const;
  Cells cells() const;
  /// Memory held, in bytes: heap, or mapped.
  std::size_t memory() const;

 private:
  // One column per field; a column uses one of the two kinds of cells. Equal strings of the whole
  // table are stored once, whatever their field.
  struct Column {
    StoredArray<std::uint64_t> numbers;  // integer and real: the integer, or the bits of the double
    StoredArray<std::uint64_t> nulls;    // integer and real: one bit per row, up to the last null
    StoredArray<std::uint32_t> texts;    // text: number of the string, or kNullText

    Column copy() const { return {numbers.copy(), nulls.copy(), texts.copy()}; }
  };
  static constexpr std::uint32_t kNullText = 0xffffffff;

  void check_types(std::span<const Value> values) const;
  void check_cells() const;
  static void append_number(Column& column, const Value& value);
  static void replace_number(Column& column, std::uint32_t row, const Value& value);
  std::uint32_t number_of(const Value& text);
  std::uint32_t intern(std::string_view text);
  std::string_view text(std::uint32_t number) const;
  void grow_slots();

  std::vector<Field> fields_;
  StoredArray<std::int64_t> ids_;
  std::vector<Column> columns_;
  StoredArray<char> string_bytes_;
  StoredArray<std::uint64_t> string_ends_;
  // Open addressing over string numbers, keyed by the bytes. The size is a power of two. Created
  // when text is appended.
  std::vector<std::uint32_t> string_slots_;
};

}  // namespace trapeze
