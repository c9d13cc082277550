// A digest by which equal inputs are recognized without storing them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace trapeze {

/// 128 bits. Different inputs practically always have different digests: among a billion, two
/// collide with a probability of 10^-21. That holds for naturally occurring inputs; it is no
/// protection against someone who searches for collisions.
struct Digest {
  std::uint64_t low = 0;
  std::uint64_t high = 0;

  friend constexpr auto operator<=>(const Digest&, const Digest&) = default;
};

/// Digests a sequence of 64-bit words. The result is equal on every machine.
class Digester {
 public:
  void add(std::uint64_t word) {
    ++words_;
    if (words_ % 2 != 0) {
      first_ = word;
    } else {
      add_pair(first_, word);
    }
  }

  /// Digest of all words so far; their number counts too.
  Digest digest() const {
    Digester end = *this;
    if (words_ % 2 != 0) end.add_pair(first_, 0);
    std::uint64_t a = end.a_ ^ words_;
    std::uint64_t b = end.b_ ^ words_;
    a += b;
    b += a;
    a = mixed(a);
    b = mixed(b);
    a += b;
    b += a;
    return {a, b};
  }

 private:
  // The steps of MurmurHash3 for 128 bits, by Austin Appleby, who placed it in the public domain.
  static constexpr std::uint64_t kFirst = 0x87c37b91114253d5;
  static constexpr std::uint64_t kSecond = 0x4cf5ad432745937f;

  void add_pair(std::uint64_t first, std::uint64_t second) {
    a_ ^= std::rotl(first * kFirst, 31) * kSecond;
    a_ = (std::rotl(a_, 27) + b_) * 5 + 0x52dce729;
    b_ ^= std::rotl(second * kSecond, 33) * kFirst;
    b_ = (std::rotl(b_, 31) + a_) * 5 + 0x38495ab5;
  }

  static std::uint64_t mixed(std::uint64_t word) {
    word ^= word >> 33;
    word *= 0xff51afd7ed558ccd;
    word ^= word >> 33;
    word *= 0xc4ceb9fe1a85ec53;
    return word ^ word >> 33;
  }

  std::uint64_t a_ = 0;
  std::uint64_t b_ = 0;
  std::uint64_t words_ = 0;
  std::uint64_t first_ = 0;  // of a pair whose second word is still to come
};

}  // namespace trapeze
