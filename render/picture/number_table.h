// Small numbers for keys, by open addressing.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace trapeze {

/// Spreads words over all 64 bits, of which the upper half is the better one.
inline std::uint64_t hash_of(std::span<const std::uint64_t> words) {
  std::uint64_t hash = 0;
  for (const std::uint64_t word : words) {
    hash = std::rotl((hash ^ word) * 0x9e3779b97f4a7c15, 29);
  }
  return hash * 0xc2b2ae3d27d4eb4f;
}

/// Gives keys numbers, for one set of keys after the other. The caller holds the keys, by number.
/// It is only as large as the last set needed, so that it remains in the processor's cache. One
/// thread at a time.
class NumberTable {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// The number of the key with that hash for which is_same(number) holds; kNone, to be set, if it
  /// is new. Lasts until the next call.
  template <typename IsSame>
  std::uint32_t& find(std::uint64_t hash, const IsSame& is_same) {
    if (count_ * 2 >= slots_.size()) grow();
    const auto tag = static_cast<std::uint32_t>(hash >> 32);
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = tag & mask;
    for (; slots_[i].generation == generation_; i = (i + 1) & mask) {
      if (slots_[i].tag == tag && is_same(slots_[i].number)) return slots_[i].number;
    }
    slots_[i] = {tag, kNone, generation_};
    ++count_;
    return slots_[i].number;
  }

  /// Forgets all keys.
  void clear() {
    slots_.resize(std::min(slots_.size(), std::bit_ceil(std::max(kLeastSlots, 2 * count_))));
    count_ = 0;
    if (++generation_ != 0) return;
    std::fill(slots_.begin(), slots_.end(), Slot{});
    generation_ = 1;
  }

 private:
  static constexpr std::size_t kLeastSlots = 64;

  struct Slot {
    std::uint32_t tag = 0;
    std::uint32_t number = 0;
    std::uint32_t generation = 0;  // it is empty if this is not the table's
  };

  void grow() {
    std::vector<Slot> old(slots_.size() * 2);
    old.swap(slots_);
    const std::size_t mask = slots_.size() - 1;
    for (const Slot& slot : old) {
      if (slot.generation != generation_) continue;
      std::size_t i = slot.tag & mask;
      while (slots_[i].generation == generation_) i = (i + 1) & mask;
      slots_[i] = slot;
    }
  }

  std::vector<Slot> slots_ = std::vector<Slot>(kLeastSlots);
  std::size_t count_ = 0;
  std::uint32_t generation_ = 1;
};

}  // namespace trapeze
