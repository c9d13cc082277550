// Ids and attributes of the features of a layer, by row; geometry lives elsewhere under the same row.
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
  /// field's type. `id` is the source's own feature id.
  std::uint32_t append(std::int64_t id, std::span<const Value> values);

  std::size_t size() const { return ids_.size(); }
  std::span<const Field> fields() const { return fields_; }
  /// Number of the field of that name, or -1.
  int field_index(std::string_view name) const;
  std::int64_t id(std::uint32_t row) const { return ids_[row]; }
  Value value(std::uint32_t row, int field) const;
  /// Heap memory held, in bytes.
  std::size_t memory() const;

 private:
  // One column a field. Cells of all types are 64 bits wide: the integer, the bits of the double,
  // or the number of the string in strings_; equal strings of one field are stored once.
  struct Column {
    std::vector<std::uint64_t> cells;
    std::vector<bool> nulls;
  };

  std::uint64_t intern(std::string_view text);

  std::vector<Field> fields_;
  std::vector<std::int64_t> ids_;
  std::vector<Column> columns_;
  std::string string_bytes_;
  std::vector<std::uint64_t> string_ends_;
  // Open addressing over string numbers (+ 1; 0 is free), keyed by the bytes.
  std::vector<std::uint32_t> string_slots_;
};

}  // namespace trapeze
