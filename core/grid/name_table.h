// The names of the enumerators of an enumeration, defined in one place.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace trapeze {

/// Values and their names, each once. May be used from any thread.
template <typename Value, std::size_t count>
class NameTable {
 public:
  struct Entry {
    std::string_view name;
    Value value;
  };

  consteval explicit NameTable(const Entry (&entries)[count]) {
    for (std::size_t i = 0; i < count; ++i) {
      names_[i] = entries[i].name;
      values_[i] = entries[i].value;
    }
  }

  /// In the order of the table.
  constexpr std::span<const std::string_view> names() const { return names_; }
  constexpr std::span<const Value> values() const { return values_; }

  constexpr std::optional<Value> find(std::string_view name) const {
    for (std::size_t i = 0; i < count; ++i) {
      if (names_[i] == name) return values_[i];
    }
    return std::nullopt;
  }

  /// Precondition: the value is in the table.
  constexpr std::string_view name_of(Value value) const {
    std::size_t i = 0;
    while (i + 1 < count && values_[i] != value) ++i;
    assert(values_[i] == value);
    return names_[i];
  }

 private:
  std::array<std::string_view, count> names_{};
  std::array<Value, count> values_{};
};

}  // namespace trapeze
