// Numbers and texts serialized one after another in memory, for the small parts of a file, in the
// byte order of the machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace trapeze {

class ByteWriter {
 public:
  template <typename Number>
  void add(Number number) {
    static_assert(std::is_integral_v<Number>);
    add_bytes(&number, sizeof number);
  }
  void add_text(std::string_view text) {
    add(std::uint64_t{text.size()});
    add_bytes(text.data(), text.size());
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  void add_bytes(const void* bytes, std::size_t size) {
    const std::size_t begin = bytes_.size();
    bytes_.resize(begin + size);
    if (size > 0) std::memcpy(bytes_.data() + begin, bytes, size);
  }

  std::vector<std::byte> bytes_;
};

/// Throws std::invalid_argument if fewer bytes remain than requested.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <typename Number>
  Number take() {
    static_assert(std::is_integral_v<Number>);
    Number number{};
    std::memcpy(&number, take_bytes(sizeof number).data(), sizeof number);
    return number;
  }
  std::string take_text() {
    const auto bytes = take_bytes(take<std::uint64_t>());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  /// The number of items that follow, each of at least `least_bytes`.
  std::size_t take_count(std::size_t least_bytes) {
    const auto count = take<std::uint64_t>();
    if (count > rest_.size() / least_bytes) fail();
    return count;
  }
  bool is_at_end() const { return rest_.empty(); }

 private:
  [[noreturn]] static void fail() { throw std::invalid_argument("the description is cut off"); }

  std::span<const std::byte> take_bytes(std::uint64_t size) {
    if (size > rest_.size()) fail();
    const auto bytes = rest_.first(size);
    rest_ = rest_.subspan(size);
    return bytes;
  }

  std::span<const std::byte> rest_;
};

}  // namespace trapeze
