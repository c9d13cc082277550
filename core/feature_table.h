// Ids and attributes of the features of a layer, by row; geometry lives elsewhere under the same
// row.
//
// Thread-safety: immutable once filled, any number of threads may read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace trapeze {

enum class FieldType : std::uint8_t { integer, real, text };

struct Field {
  std::string name;
  FieldType type = FieldType::text;
};

/// Null is std::monostate. The string looks at memory of the table.
using Value = std::variant<std::monostate, std::int64_t, double, std::string_view>;

class FeatureTable {
 public:
  FeatureTable() = default;
  explicit FeatureTable(std::vector<Field> fields);

  /// Appends a row and returns its number; `values` are as many as fields, each null or of its
  /// field's type (std::invalid_argument if not). `id` is the source's own feature id.
  std::uint32_t append(std::int64_t id, std::span<const Value> values);

  std::size_t size() const { return ids_.size(); }
  std::span<const Field> fields() const { return fields_; }
  /// Number of the first field of that name, or -1.
  int field_index(std::string_view name) const;
  std::int64_t id(std::uint32_t row) const { return ids_[row]; }
  /// `row` < size(), 0 <= `field` < fields().size().
  Value value(std::uint32_t row, int field) const;
  /// Heap memory held, in bytes.
  std::size_t memory() const;

 private:
  // One column a field; a column uses one of the two kinds of cells. Equal strings of the whole
  // table are stored once, whatever their field.
  struct Column {
    std::vector<std::uint64_t> numbers;  // integer and real: the integer, or the bits of the double
    std::vector<bool> nulls;             // integer and real: as long as up to the last null
    std::vector<std::uint32_t> texts;    // text: number of the string, or kNullText
  };
  static constexpr std::uint32_t kNullText = 0xffffffff;

  void check_types(std::span<const Value> values) const;
  void append_number(Column& column, const Value& value);
  std::uint32_t intern(std::string_view text);
  std::string_view text(std::uint32_t number) const;
  void grow_slots();

  std::vector<Field> fields_;
  std::vector<std::int64_t> ids_;
  std::vector<Column> columns_;
  std::string string_bytes_;
  std::vector<std::uint64_t> string_ends_;
  // Open addressing over string numbers, keyed by the bytes; the size is a power of two.
  std::vector<std::uint32_t> string_slots_;
};

}  // namespace trapeze
