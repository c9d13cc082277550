#include "server/values/joined_values.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

namespace trapeze {
namespace {

std::optional<double> number_in(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!std::isfinite(number)) return std::nullopt;
  return number;
}

/// Integers keep all of their digits.
std::optional<std::int64_t> integer_in(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  std::int64_t integer = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), integer);
  if (error == std::errc() && end == text.data() + text.size()) return integer;
  const auto number = number_in(text);  // for example 7.0
  constexpr double kExact = 9007199254740992;
  if (!number || std::floor(*number) != *number || std::abs(*number) > kExact) return std::nullopt;
  return static_cast<std::int64_t>(*number);
}

/// The rows of a table by numeric key.
template <typename Number>
class NumberedRows {
 public:
  template <typename Read>
  NumberedRows(const ValueTable& table, Read read) {
    std::string with_point;
    for (std::uint32_t row = 0; row < table.size(); ++row) {
      std::string_view key = table.key(row);
      if (table.has_decimal_commas()) {
        with_point = key;
        std::ranges::replace(with_point, ',', '.');
        key = with_point;
      }
      if (const std::optional<Number> number = read(key)) rows_.emplace_back(*number, row);
    }
    std::ranges::sort(rows_);
  }

  /// Two rows with the same number.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> find_double() const {
    const auto found = std::ranges::adjacent_find(
        rows_, [](const auto& a, const auto& b) { return a.first == b.first; });
    if (found == rows_.end()) return std::nullopt;
    return std::pair(found->second, (found + 1)->second);
  }
  std::optional<std::uint32_t> find(Number number) const {
    const auto found =
        std::ranges::lower_bound(rows_, number, {}, &std::pair<Number, std::uint32_t>::first);
    if (found == rows_.end() || found->first != number) return std::nullopt;
    return found->second;
  }

 private:
  std::vector<std::pair<Number, std::uint32_t>> rows_;
};

Problem same_number(const ValueTable& table, std::pair<std::uint32_t, std::uint32_t> rows,
                    const std::string& attribute) {
  return {400,
          fmt::format("The attribute {} holds numbers, and the keys {} and {} are the same one.",
                      attribute, table.key(rows.first), table.key(rows.second)),
          "join", attribute, "an attribute of texts, or a table with each key once"};
}

}  // namespace

Result<std::shared_ptr<const JoinedValues>> JoinedValues::join(
    std::shared_ptr<const ValueTable> table, const Layer& layer, int field) {
  auto joined = std::make_shared<JoinedValues>();
  const FeatureTable& features = layer.features();
  const Field& attribute = features.fields()[static_cast<std::size_t>(field)];
  joined->key_ = key_of(*table, field);
  joined->rows_.assign(features.size(), kNone);
  joined->is_matched_.assign(table->size(), false);
  const auto match_all = [&](auto find) {
    for (std::uint32_t row = 0; row < features.size(); ++row) {
      if (layer.is_removed(row)) continue;
      const std::optional<std::uint32_t> found = find(features.value(row, field));
      if (!found) {
        ++joined->unmatched_features_;
        continue;
      }
      joined->rows_[row] = *found;
      joined->is_matched_[*found] = true;
    }
  };
  using Found = std::optional<std::uint32_t>;
  if (attribute.type == FieldType::text) {
    match_all([&](const Value& value) {
      const auto* text = std::get_if<std::string_view>(&value);
      return text == nullptr ? Found() : table->find(*text);
    });
  } else if (attribute.type == FieldType::integer) {
    const NumberedRows<std::int64_t> rows(*table, integer_in);
    if (const auto both = rows.find_double()) return same_number(*table, *both, attribute.name);
    match_all([&](const Value& value) {
      const auto* number = std::get_if<std::int64_t>(&value);
      return number == nullptr ? Found() : rows.find(*number);
    });
  } else {
    const NumberedRows<double> rows(*table, number_in);
    if (const auto both = rows.find_double()) return same_number(*table, *both, attribute.name);
    match_all([&](const Value& value) {
      const auto* number = std::get_if<double>(&value);
      return number == nullptr ? Found() : rows.find(*number);
    });
  }
  for (std::uint32_t row = 0; row < table->size(); ++row) {
    if (joined->is_matched_[row]) continue;
    if (joined->unmatched_rows_++ < kMostNamed) {
      joined->unmatched_keys_.emplace_back(table->key(row));
    }
  }
  joined->table_ = std::move(table);
  return std::shared_ptr<const JoinedValues>(std::move(joined));
}

std::string JoinedValues::key_of(const ValueTable& table, int field) {
  return fmt::format("{}@{}", table.id(), field);
}

ValueSpread JoinedValues::spread() const {
  SpreadCollector collector;
  for (std::uint32_t row = 0; row < table_->size(); ++row) {
    if (is_matched_[row]) collector.add(table_->value(row));
  }
  return collector.take();
}

std::size_t JoinedValues::memory() const {
  return sizeof *this + rows_.capacity() * sizeof(std::uint32_t) + is_matched_.capacity() / 8;
}

}  // namespace trapeze
