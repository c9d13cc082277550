// A hash for recognising contents (entity tags): XXH3, stable across runs and machines, not against
// attackers.
//
// Thread-safety: one thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace trapeze {

class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  ContentHash(const ContentHash&) = delete;
  ContentHash& operator=(const ContentHash&) = delete;

  void add(std::uint64_t word);
  /// Its length counts, so that texts that follow each other cannot be taken for other ones.
  void add(std::string_view text);

  /// T has no padding, so that equal values are equal bytes.
  template <typename T>
  void add(std::span<const T> values) {
    static_assert(std::has_unique_object_representations_v<T>);
    add(std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
  }

  /// 64 bits of all that was added.
  std::uint64_t value() const;
  /// 128 bits of it, as 32 hex digits.
  std::string hex() const;

 private:
  struct State;
  const std::unique_ptr<State> state_;
};

}  // namespace trapeze
