#include "server/values/value_table.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "server/base/digest.h"
#include "server/base/nearest_name.h"
#include "server/base/seeded_hash.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kFree = 0xffffffff;
constexpr std::size_t kMostDoublesNamed = 10;
constexpr std::size_t kLongestNumber = 64;  // bytes; more digits than a double needs

// In numeric columns only: in a table of words, these are words. Used for missing numbers by R,
// pandas, spreadsheets, the World Bank and Eurostat.
constexpr std::array<std::string_view, 9> kMissing = {"na", "n/a",  "#n/a", "nan", "null",
                                                      "-",  "none", "..",   ":"};

bool is_missing_number(std::string_view text) {
  return text.empty() || std::ranges::find(kMissing, in_lower_case(text)) != kMissing.end();
}

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

/// The number with a point in place of a decimal comma.
class PlainNumber {
 public:
  PlainNumber(std::string_view text, bool has_decimal_commas) : text_(text) {
    if (text_.starts_with('+') && text_.size() > 1 && text_[1] != '-') text_.remove_prefix(1);
    if (!has_decimal_commas || text_.size() > kLongestNumber) return;
    const std::size_t comma = text_.find(',');
    if (comma == std::string_view::npos) return;
    std::ranges::copy(text_, buffer_.begin());
    buffer_[comma] = '.';
    text_ = {buffer_.data(), text_.size()};
  }
  PlainNumber(const PlainNumber&) = delete;
  PlainNumber& operator=(const PlainNumber&) = delete;

  template <typename Number>
  std::errc read(Number& number) const {
    const char* end = text_.data() + text_.size();
    const auto [read_to, error] = std::from_chars(text_.data(), end, number);
    return error == std::errc() && read_to != end ? std::errc::invalid_argument : error;
  }

 private:
  std::string_view text_;
  std::array<char, kLongestNumber> buffer_{};
};

enum class CellKind { missing, integer, real, endless, word };

/// The kind of a value, and its number if it is one.
struct Cell {
  CellKind kind = CellKind::missing;
  std::int64_t integer = 0;
  double real = 0;
};

/// -0 becomes 0.
std::uint64_t bits_of(double number) {
  return std::bit_cast<std::uint64_t>(number + 0.0);
}

Cell read_cell(std::string_view text, bool has_decimal_commas) {
  Cell cell;
  if (text.empty()) return cell;
  const PlainNumber number(text, has_decimal_commas);
  if (number.read(cell.integer) == std::errc()) {
    cell.kind = CellKind::integer;
    cell.real = static_cast<double>(cell.integer);
    return cell;
  }
  const std::errc error = number.read(cell.real);
  if (error == std::errc() && std::isfinite(cell.real)) {
    cell.kind = CellKind::real;
    return cell;
  }
  if (is_missing_number(text)) return cell;
  const bool is_endless =
      error == std::errc::result_out_of_range || (error == std::errc() && std::isinf(cell.real));
  cell.kind = is_endless ? CellKind::endless : CellKind::word;
  return cell;
}

}  // namespace

std::string_view ValueTable::key(std::uint32_t row) const {
  return std::string_view(text_).substr(rows_[row].begin, rows_[row].key_size);
}

Value ValueTable::value(std::uint32_t row) const {
  if (!has_value_[row]) return {};
  if (type_ == FieldType::integer) return std::bit_cast<std::int64_t>(numbers_[row]);
  if (type_ == FieldType::real) return std::bit_cast<double>(numbers_[row]);
  const Row& place = rows_[row];
  return std::string_view(text_).substr(place.begin + place.key_size, place.value_size);
}

std::optional<std::uint32_t> ValueTable::find(std::string_view wanted) const {
  if (slots_.empty()) return std::nullopt;
  // At most half of the slots are occupied, so a search always ends.
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = seeded_hash(wanted) & mask;
  while (slots_[slot] != kFree) {
    if (key(slots_[slot]) == wanted) return slots_[slot];
    slot = (slot + 1) & mask;
  }
  return std::nullopt;
}

std::size_t ValueTable::memory() const {
  return sizeof *this + text_.capacity() + rows_.capacity() * sizeof(Row) +
         numbers_.capacity() * sizeof(std::uint64_t) + has_value_.capacity() / 8 +
         slots_.capacity() * sizeof(std::uint32_t) + names_.key.size() + names_.value.size();
}

ValueTableBuilder::ValueTableBuilder(ValueNames names, std::size_t max_rows,
                                     bool has_decimal_commas)
    : max_rows_(max_rows), has_decimal_commas_(has_decimal_commas) {
  table_.names_ = std::move(names);
}

void ValueTableBuilder::reserve(std::size_t rows, std::size_t bytes) {
  const std::size_t most = std::min(rows, max_rows_);
  table_.text_.reserve(bytes);
  table_.rows_.reserve(most);
  places_.reserve(most);
  grow_slots(most);
}

std::optional<Problem> ValueTableBuilder::add(std::string_view key, std::string_view value,
                                              std::size_t place) {
  key = without_blanks(key);
  value = without_blanks(value);
  if (key.empty()) {
    if (!value.empty()) ++table_.without_key_;
    return std::nullopt;
  }
  if (key.size() > kMaxTextBytes || value.size() > kMaxTextBytes) {
    return Problem{400, fmt::format("Keys and values are at most {} bytes long; row {} has a "
                                    "longer one.",
                                    kMaxTextBytes, place)};
  }
  if (table_.rows_.size() == max_rows_) {
    return Problem{413, fmt::format("A table has at most {} rows here.", max_rows_)};
  }
  if (table_.text_.size() + key.size() + value.size() > std::numeric_limits<std::uint32_t>::max()) {
    return Problem{413, "A table has at most 4 GB of text."};
  }
  // Only with a comma to read, because it is part of the identity.
  table_.has_decimal_commas_ |= has_decimal_commas_ && key.find(',') != std::string_view::npos;
  const auto row = static_cast<std::uint32_t>(table_.rows_.size());
  table_.rows_.push_back({static_cast<std::uint32_t>(table_.text_.size()),
                          static_cast<std::uint16_t>(key.size()),
                          static_cast<std::uint16_t>(value.size())});
  table_.text_ += key;
  table_.text_ += value;
  places_.push_back(static_cast<std::uint32_t>(place));
  if (insert(key, row)) return std::nullopt;
  // Reported at the end, together with the others.
  if (++doubles_ <= kMostDoublesNamed) {
    double_keys_ += fmt::format("{}{} (rows {} and {})", double_keys_.empty() ? "" : ", ", key,
                                places_[*table_.find(key)], place);
  }
  return std::nullopt;
}

/// False if the key already exists.
bool ValueTableBuilder::insert(std::string_view key, std::uint32_t row) {
  if (table_.slots_.size() < 2 * (std::size_t{row} + 1)) grow_slots(2 * (std::size_t{row} + 1));
  const std::size_t mask = table_.slots_.size() - 1;
  std::size_t slot = seeded_hash(key) & mask;
  while (table_.slots_[slot] != kFree) {
    const std::uint32_t taken = table_.slots_[slot];
    if (table_.key(taken) == key) return false;
    slot = (slot + 1) & mask;
  }
  table_.slots_[slot] = row;
  return true;
}

void ValueTableBuilder::grow_slots(std::size_t rows) {
  constexpr std::size_t kFirstSlots = 64;
  const std::size_t size = std::max(kFirstSlots, std::bit_ceil(2 * (rows + 1)));
  if (size <= table_.slots_.size()) return;
  const std::vector<std::uint32_t> taken = std::exchange(table_.slots_, {});
  table_.slots_.assign(size, kFree);
  for (const std::uint32_t row : taken) {
    if (row == kFree) continue;
    std::size_t slot = seeded_hash(table_.key(row)) & (size - 1);
    while (table_.slots_[slot] != kFree) slot = (slot + 1) & (size - 1);
    table_.slots_[slot] = row;
  }
}

Result<ValueTable> ValueTableBuilder::finish() && {
  if (doubles_ > 0) {
    const std::string more = doubles_ > kMostDoublesNamed
                                 ? fmt::format(" and {} more", doubles_ - kMostDoublesNamed)
                                 : "";
    return Problem{400, fmt::format("Keys must be unique; these occur more than once: {}{}.",
                                    double_keys_, more)};
  }
  if (table_.rows_.empty()) return Problem{400, "The table has no row with a key."};
  if (auto problem = find_type()) return std::move(*problem);
  table_.text_.shrink_to_fit();
  table_.rows_.shrink_to_fit();
  table_.id_ = identity();
  return std::move(table_);
}

/// Numeric if all values are numbers; the problem is an infinite number in such a table.
std::optional<Problem> ValueTableBuilder::find_type() {
  bool has_words = false;
  bool has_reals = false;
  std::optional<std::uint32_t> endless;
  std::vector<bool>& has_value = table_.has_value_;
  has_value.assign(table_.rows_.size(), false);
  std::vector<std::uint64_t> numbers(table_.rows_.size(), 0);
  for (std::uint32_t row = 0; row < has_value.size() && !has_words; ++row) {
    const Cell cell = read_cell(text_of_value(row), has_decimal_commas_);
    has_value[row] = cell.kind != CellKind::missing;
    if (cell.kind == CellKind::real && !has_reals) {
      has_reals = true;  // all values before it become reals as well
      for (std::uint32_t before = 0; before < row; ++before) {
        numbers[before] =
            bits_of(static_cast<double>(std::bit_cast<std::int64_t>(numbers[before])));
      }
    }
    if (has_value[row]) {
      numbers[row] = has_reals ? bits_of(cell.real) : std::bit_cast<std::uint64_t>(cell.integer);
    }
    if (cell.kind == CellKind::endless && !endless) endless = row;
    has_words = cell.kind == CellKind::word;
    if (has_words) table_.first_word_ = text_of_value(row);
  }
  if (has_words) {
    table_.type_ = FieldType::text;
    for (std::uint32_t row = 0; row < has_value.size(); ++row) {
      has_value[row] = table_.rows_[row].value_size > 0;
    }
  } else if (endless) {
    return Problem{400,
                   fmt::format("The value of {} (row {}) is {}, but values must be finite: leave "
                               "it empty if there is none.",
                               table_.key(*endless), places_[*endless], text_of_value(*endless))};
  } else {
    table_.type_ = has_reals ? FieldType::real : FieldType::integer;
    table_.numbers_ = std::move(numbers);
    give_up_text();
  }
  table_.missing_ = static_cast<std::size_t>(std::count(has_value.begin(), has_value.end(), false));
  return std::nullopt;
}

std::string_view ValueTableBuilder::text_of_value(std::uint32_t row) const {
  const ValueTable::Row& place = table_.rows_[row];
  return std::string_view(table_.text_).substr(place.begin + place.key_size, place.value_size);
}

/// For numbers: removes everything but the keys from the text, and moves these together.
void ValueTableBuilder::give_up_text() {
  std::string& text = table_.text_;
  std::uint32_t end = 0;
  for (ValueTable::Row& place : table_.rows_) {
    std::copy_n(text.begin() + place.begin, place.key_size, text.begin() + end);
    place = {end, place.key_size, 0};
    end += place.key_size;
  }
  text.resize(end);
}

/// A digest of the whole contents: keys, each followed by its word, are in the text in row order.
std::string ValueTableBuilder::identity() const {
  const std::string head =
      fmt::format("{}:{} {}:{} {} {} {}", table_.names_.key.size(), table_.names_.key,
                  table_.names_.value.size(), table_.names_.value, static_cast<int>(table_.type_),
                  table_.rows_.size(), table_.has_decimal_commas_ ? "," : "");
  std::vector<std::uint32_t> sizes(table_.rows_.size());
  for (std::uint32_t row = 0; row < table_.rows_.size(); ++row) {
    const ValueTable::Row& place = table_.rows_[row];
    sizes[row] = std::uint32_t{place.key_size} << 11 |  // both are at most 256
                 std::uint32_t{place.value_size} << 1 | std::uint32_t{table_.has_value_[row]};
  }
  const auto bytes_of = [](const auto& numbers) {
    return std::string_view(reinterpret_cast<const char*>(numbers.data()),
                            numbers.size() * sizeof numbers[0]);
  };
  const std::array<std::string_view, 4> parts = {head, bytes_of(sizes), table_.text_,
                                                 bytes_of(table_.numbers_)};
  return digest_of(parts);
}

}  // namespace trapeze
