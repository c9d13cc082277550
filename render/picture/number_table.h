// Small numbers for keys, by open addressing.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace trapeze {

/// Mixes words into 64 bits, of which the upper half is better distributed.
inline std::uint64_t hash_of(std::span<const std::uint64_t> words) {
  std::uint64_t hash = 0;
  for (const std::uint64_t word : words) {
    hash = std::rotl((hash ^ word) * 0x9e3779b97f4a7c15, 29);
  }
  return hash * 0xc2b2ae3d27d4eb4f;
}

/// Assigns numbers to keys, for one set of keys after the other. The caller stores the keys, by
/// number. The table is only as large as the last set needed, so that it stays in the processor's
/// cache. One thread at a time.
class NumberTable {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// The number of the key with that hash, of which only the upper half is used, for which
  /// is_same(number) holds; kNone, to be set, if the key is new. The reference is valid until the
  /// next call.
  template <typename IsSame>
  std::uint32_t& find(std::uint64_t hash, const IsSame& is_same) {
    if (count_ * 2 >= slots_.size()) grow();
    const auto tag = static_cast<std::uint32_t>(hash >> 32);
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = tag & mask;
    for (; slots_[i].number != kNone; i = (i + 1) & mask) {
      if (slots_[i].tag == tag && is_same(slots_[i].number)) return slots_[i].number;
    }
    slots_[i].tag = tag;
    ++count_;
    return slots_[i].number;
  }

  /// The same without adding anything: kNone if there is no such key.
  template <typename IsSame>
  std::uint32_t look_up(std::uint64_t hash, const IsSame& is_same) const {
    const auto tag = static_cast<std::uint32_t>(hash >> 32);
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t i = tag & mask; slots_[i].number != kNone; i = (i + 1) & mask) {
      if (slots_[i].tag == tag && is_same(slots_[i].number)) return slots_[i].number;
    }
    return kNone;
  }

  /// Call it some time before find() if a table may be too large for the processor's cache.
  void prefetch(std::uint64_t hash) const {
    __builtin_prefetch(&slots_[(hash >> 32) & (slots_.size() - 1)]);
  }

  /// Removes all keys.
  void clear() {
    const std::size_t size =
        std::min(slots_.size(), std::bit_ceil(std::max(kLeastSlots, 2 * count_)));
    slots_.assign(size, Slot());
    count_ = 0;
  }

 private:
  static constexpr std::size_t kLeastSlots = 64;

  struct Slot {
    std::uint32_t tag = 0;
    std::uint32_t number = kNone;  // kNone: empty
  };

  void grow() {
    std::vector<Slot> old(slots_.size() * 2);
    old.swap(slots_);
    const std::size_t mask = slots_.size() - 1;
    for (const Slot& slot : old) {
      if (slot.number == kNone) continue;
      std::size_t i = slot.tag & mask;
      while (slots_[i].number != kNone) i = (i + 1) & mask;
      slots_[i] = slot;
    }
  }

  std::vector<Slot> slots_ = std::vector<Slot>(kLeastSlots);
  std::size_t count_ = 0;
};

}  // namespace trapeze
