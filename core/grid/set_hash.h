// A hash of items that come in any order, possibly several times, and can be removed again.
//
// It is the sum of a 128-bit hash of each item: for recognizing contents, not for protection
// against attackers.
#pragma once

#include <array>
#include <cstdint>

#include "core/grid/digest.h"

namespace trapeze {

/// The digest is equal for equal multisets of items, and Digest() for none. It is the same on every
/// machine.
class SetHash {
 public:
  using Item = std::array<std::uint64_t, 3>;

  void add(const Item& item) { change(item, false); }
  void take_away(const Item& item) { change(item, true); }

  const Digest& digest() const { return sum_; }

 private:
  __extension__ using Product = unsigned __int128;

  static std::uint64_t low_of(Product product) { return static_cast<std::uint64_t>(product); }
  static std::uint64_t high_of(Product product) {
    return static_cast<std::uint64_t>(product >> 64);
  }

  void change(const Item& item, bool is_less) {
    const Product first = Product{item[0] ^ 0x9e3779b97f4a7c15} * (item[1] ^ 0xc2b2ae3d27d4eb4f);
    const std::uint64_t rest = item[2] ^ 0x165667b19e3779f9;
    const Product second = Product{low_of(first) ^ rest} * (high_of(first) ^ 0x27d4eb2f165667c5);
    const std::uint64_t low = low_of(second) ^ (rest * 0xff51afd7ed558ccd);
    const std::uint64_t high = (high_of(second) ^ low_of(first)) * 0xc4ceb9fe1a85ec53;
    sum_.low += is_less ? -low : low;
    sum_.high += is_less ? -high : high;
  }

  Digest sum_;
};

}  // namespace trapeze
