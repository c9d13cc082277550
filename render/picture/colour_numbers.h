// Numbers for colours.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/picture/colour.h"
#include "render/picture/number_table.h"
#include "render/picture/origin.h"

namespace trapeze {

inline std::uint32_t bits_of(Rgba colour) {
  return std::bit_cast<std::uint32_t>(colour);
}

/// Distinct colours, in order of first occurrence.
class ColourNumbers {
 public:
  void clear() {
    numbers_.clear();
    colours_.clear();
    origins_.clear();
  }

  /// The number of the colour, from 0. If a colour has several origins, the first one in the
  /// enumeration is kept.
  std::uint32_t number_of(Rgba colour, Origin origin) {
    std::uint32_t& number = numbers_.find(hash_of(colour), is_same);
    if (number == NumberTable::kNone) {
      number = static_cast<std::uint32_t>(colours_.size());
      colours_.push_back(colour);
      origins_.push_back(origin);
    }
    origins_[number] = std::min(origins_[number], origin);
    return number;
  }

  /// The number of a known colour; otherwise NumberTable::kNone.
  std::uint32_t look_up(Rgba colour) const { return numbers_.look_up(hash_of(colour), is_same); }

  std::size_t size() const { return colours_.size(); }
  // By number.
  const std::vector<Rgba>& colours() const { return colours_; }
  const std::vector<Origin>& origins() const { return origins_; }

 private:
  // Each step is reversible, so no two colours have the same upper half of the hash, which is all
  // that the table stores. There is nothing left to compare.
  static std::uint64_t hash_of(Rgba colour) {
    std::uint32_t bits = bits_of(colour);
    bits = (bits ^ bits >> 16) * 0x7feb352d;
    bits = (bits ^ bits >> 15) * 0x846ca68b;
    return std::uint64_t{bits ^ bits >> 16} << 32;
  }
  static bool is_same(std::uint32_t) { return true; }

  NumberTable numbers_;
  std::vector<Rgba> colours_;
  std::vector<Origin> origins_;
};

}  // namespace trapeze
