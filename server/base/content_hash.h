// A 64-bit hash for recognising contents (entity tags): stable across runs, not against attackers.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace trapeze {

class ContentHash {
 public:
  void add(std::uint64_t word) {
    // Multiply-xorshift: every bit of the input reaches every bit of the state.
    state_ = (state_ ^ word) * 0x9E3779B97F4A7C15u;
    state_ ^= state_ >> 32;
  }

  void add(std::string_view text) {
    add(text.size());
    add_bytes(text.data(), text.size());
  }

  /// T has no padding, so that equal values are equal bytes.
  template <typename T>
  void add(std::span<const T> values) {
    static_assert(std::has_unique_object_representations_v<T>);
    add(values.size());
    add_bytes(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }

  std::uint64_t value() const { return state_; }

 private:
  void add_bytes(const char* bytes, std::size_t size) {
    std::uint64_t word = 0;
    for (; size >= sizeof word; bytes += sizeof word, size -= sizeof word) {
      std::memcpy(&word, bytes, sizeof word);
      add(word);
    }
    word = 0;
    if (size > 0) {
      std::memcpy(&word, bytes, size);
      add(word);
    }
  }

  std::uint64_t state_ = 0x243F6A8885A308D3u;  // pi, so that leading zeros count
};

}  // namespace trapeze
