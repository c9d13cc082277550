// A hash for recognising contents (entity tags): XXH3, stable across runs and machines, not secure
// against attackers.
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
  /// The length is hashed, too, so that a sequence of texts is unambiguous.
  void add(std::string_view text);

  /// T must have no padding, so that equal values have equal bytes.
  template <typename T>
  void add(std::span<const T> values) {
    static_assert(std::has_unique_object_representations_v<T>);
    add(std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
  }

  /// The 64-bit hash of everything added.
  std::uint64_t value() const;
  /// The 128-bit hash of everything added, as 32 hex digits.
  std::string hex() const;

 private:
  struct State;
  const std::unique_ptr<State> state_;
};

}  // namespace trapeze
