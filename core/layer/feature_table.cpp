#include "core/layer/feature_table.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <stdexcept>
#include <utility>

#include "core/grid/item_count.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kFreeSlot = 0xffffffff;
constexpr std::size_t kFirstSlots = 64;
constexpr std::size_t kBits = 64;  // rows per word of nulls

bool has_type(const Value& value, FieldType type) {
  switch (type) {
    case FieldType::integer:
      return std::holds_alternative<std::int64_t>(value);
    case FieldType::real:
      return std::holds_alternative<double>(value);
    case FieldType::text:
      return std::holds_alternative<std::string_view>(value);
  }
  return false;
}

bool is_null(const Value& value) {
  return std::holds_alternative<std::monostate>(value);
}

std::uint64_t bits_of(const Value& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    return std::bit_cast<std::uint64_t>(*integer);
  }
  if (const auto* real = std::get_if<double>(&value)) return std::bit_cast<std::uint64_t>(*real);
  return 0;
}

template <typename T>
std::size_t heap_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

// A short string is stored inside its object.
std::size_t heap_bytes(const std::string& s) {
  return s.capacity() > std::string().capacity() ? s.capacity() + 1 : 0;
}

}  // namespace

FeatureTable::FeatureTable(std::vector<Field> fields)
    : fields_(std::move(fields)), columns_(fields_.size()) {}

FeatureTable::FeatureTable(std::vector<Field> fields, const Cells& cells)
    : fields_(std::move(fields)),
      ids_(StoredArray<std::int64_t>::looking_at(cells.ids)),
      string_bytes_(StoredArray<char>::looking_at(cells.string_bytes)),
      string_ends_(StoredArray<std::uint64_t>::looking_at(cells.string_ends)) {
  for (const Cells::Column& column : cells.columns) {
    columns_.push_back({StoredArray<std::uint64_t>::looking_at(column.numbers),
                        StoredArray<std::uint64_t>::looking_at(column.nulls),
                        StoredArray<std::uint32_t>::looking_at(column.texts)});
  }
  check_cells();
}

std::uint32_t FeatureTable::append(std::int64_t id, std::span<const Value> values) {
  check_types(values);
  require_countable(ids_.size() + 1, "features");
  for (std::size_t i = 0; i < values.size(); ++i) {
    Column& column = columns_[i];
    if (fields_[i].type != FieldType::text) {
      append_number(column, values[i]);
    } else {
      column.texts.push_back(number_of(values[i]));
    }
  }
  ids_.push_back(id);
  return static_cast<std::uint32_t>(ids_.size() - 1);
}

void FeatureTable::replace(std::uint32_t row, std::span<const Value> values) {
  check_types(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (fields_[i].type != FieldType::text) {
      replace_number(columns_[i], row, values[i]);
    } else {
      columns_[i].texts.set(row, number_of(values[i]));
    }
  }
}

FeatureTable FeatureTable::copy() const {
  FeatureTable other;
  other.fields_ = fields_;
  other.ids_ = ids_.copy();
  for (const Column& column : columns_) other.columns_.push_back(column.copy());
  other.string_bytes_ = string_bytes_.copy();
  other.string_ends_ = string_ends_.copy();
  other.string_slots_ = string_slots_;
  return other;
}

void FeatureTable::shrink_to_fit() {
  ids_.shrink_to_fit();
  for (Column& column : columns_) {
    column.numbers.shrink_to_fit();
    column.nulls.shrink_to_fit();
    column.texts.shrink_to_fit();
  }
  string_bytes_.shrink_to_fit();
  string_ends_.shrink_to_fit();
  string_slots_ = {};
}

int FeatureTable::field_index(std::string_view name) const {
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    if (fields_[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

Value FeatureTable::value(std::uint32_t row, int field) const {
  const Column& column = columns_[field];
  if (fields_[field].type == FieldType::text) {
    const std::uint32_t number = column.texts[row];
    return number == kNullText ? Value() : Value(text(number));
  }
  if (row / kBits < column.nulls.size() && (column.nulls[row / kBits] >> row % kBits & 1) != 0) {
    return {};
  }
  const std::uint64_t bits = column.numbers[row];
  if (fields_[field].type == FieldType::integer) return std::bit_cast<std::int64_t>(bits);
  return std::bit_cast<double>(bits);
}

FeatureTable::Cells FeatureTable::cells() const {
  Cells cells{ids_, {}, string_bytes_, string_ends_};
  for (const Column& column : columns_) {
    cells.columns.push_back({column.numbers, column.nulls, column.texts});
  }
  return cells;
}

std::size_t FeatureTable::memory() const {
  std::size_t bytes = heap_bytes(fields_) + ids_.memory() + heap_bytes(columns_) +
                      string_bytes_.memory() + string_ends_.memory() + heap_bytes(string_slots_);
  for (const Field& field : fields_) bytes += heap_bytes(field.name);
  for (const Column& column : columns_) {
    bytes += column.numbers.memory() + column.nulls.memory() + column.texts.memory();
  }
  return bytes;
}

void FeatureTable::check_cells() const {
  require_valid(columns_.size() == fields_.size(), "there is not one column a field");
  require_valid(ids_.size() < 0xffffffff, "there are too many features");
  require_valid(string_ends_.size() < kNullText, "there are too many texts");
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const Column& column = columns_[i];
    const bool is_text = fields_[i].type == FieldType::text;
    require_valid(column.numbers.size() == (is_text ? 0 : ids_.size()),
                  "a column has not one number a row");
    require_valid(column.texts.size() == (is_text ? ids_.size() : 0),
                  "a column has not one text a row");
    const std::size_t strings = string_ends_.size();
    require_valid(
        std::ranges::all_of(column.texts,
                            [strings](std::uint32_t t) { return t < strings || t == kNullText; }),
        "a text is not there");
  }
  require_valid(std::ranges::is_sorted(string_ends_), "texts are not in order");
  require_valid(
      string_ends_.empty() || string_ends_[string_ends_.size() - 1] <= string_bytes_.size(),
      "texts end too late");
}

void FeatureTable::check_types(std::span<const Value> values) const {
  if (values.size() != fields_.size()) {
    throw std::invalid_argument("a row has " + std::to_string(values.size()) + " values for " +
                                std::to_string(fields_.size()) + " fields");
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!is_null(values[i]) && !has_type(values[i], fields_[i].type)) {
      throw std::invalid_argument("a value is not of the type of its field: " + fields_[i].name);
    }
  }
}

void FeatureTable::append_number(Column& column, const Value& value) {
  if (is_null(value)) {
    const std::size_t row = column.numbers.size();
    column.nulls.resize(row / kBits + 1);
    column.nulls.back() |= std::uint64_t{1} << row % kBits;
  }
  column.numbers.push_back(bits_of(value));
}

void FeatureTable::replace_number(Column& column, std::uint32_t row, const Value& value) {
  column.numbers.set(row, bits_of(value));
  const std::size_t word = row / kBits;
  const std::uint64_t bit = std::uint64_t{1} << row % kBits;
  if (is_null(value)) {
    if (word >= column.nulls.size()) column.nulls.resize(word + 1);
    column.nulls.set(word, column.nulls[word] | bit);
  } else if (word < column.nulls.size()) {
    column.nulls.set(word, column.nulls[word] & ~bit);
  }
}

/// The number of a value that is a text or null.
std::uint32_t FeatureTable::number_of(const Value& text) {
  return is_null(text) ? kNullText : intern(std::get<std::string_view>(text));
}

std::uint32_t FeatureTable::intern(std::string_view text_to_find) {
  // At most half of the slots are occupied, so a probe is short and always ends.
  if (string_slots_.size() < 2 * (string_ends_.size() + 1)) grow_slots();
  const std::size_t mask = string_slots_.size() - 1;
  std::size_t slot = std::hash<std::string_view>{}(text_to_find)&mask;
  while (string_slots_[slot] != kFreeSlot) {
    if (text(string_slots_[slot]) == text_to_find) return string_slots_[slot];
    slot = (slot + 1) & mask;
  }
  require_countable(string_ends_.size() + 1, "different texts");
  string_bytes_.append(text_to_find);
  string_ends_.push_back(string_bytes_.size());
  string_slots_[slot] = static_cast<std::uint32_t>(string_ends_.size() - 1);
  return string_slots_[slot];
}

std::string_view FeatureTable::text(std::uint32_t number) const {
  const std::uint64_t begin = number == 0 ? 0 : string_ends_[number - 1];
  // In a file that is truncated while it is mapped, ends may read as zero.
  const std::uint64_t end = std::max(begin, string_ends_[number]);
  return {string_bytes_.data() + begin, end - begin};
}

void FeatureTable::grow_slots() {
  const std::size_t size = std::max(kFirstSlots, std::bit_ceil(2 * (string_ends_.size() + 1)));
  string_slots_.assign(size, kFreeSlot);
  for (std::uint32_t number = 0; number < string_ends_.size(); ++number) {
    std::size_t slot = std::hash<std::string_view>{}(text(number)) & (size - 1);
    while (string_slots_[slot] != kFreeSlot) slot = (slot + 1) & (size - 1);
    string_slots_[slot] = number;
  }
}

}  // namespace trapeze
