// Small numbers for keys, by open addressing.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "render/picture/colour.h"

namespace trapeze {

/// Gives keys numbers, for one set of keys after the other. `Key` has hash(), which spreads it over
/// all 64 bits, and can be compared. One thread at a time.
template <typename Key>
class NumberTable {
 public:
  NumberTable() : slots_(1024) {}

  /// The number of the key; kNone, to be set, if it is new. Lasts until the next call.
  std::uint32_t& operator[](const Key& key) {
    if (count_ * 2 >= slots_.size()) grow();
    Slot& slot = find(key);
    if (slot.generation != generation_) {
      slot = {key, kNone, generation_};
      ++count_;
    }
    return slot.number;
  }

  /// Forgets all keys.
  void clear() {
    count_ = 0;
    if (++generation_ != 0) return;
    std::fill(slots_.begin(), slots_.end(), Slot{});
    generation_ = 1;
  }

  static constexpr std::uint32_t kNone = 0xffffffff;

 private:
  struct Slot {
    Key key{};
    std::uint32_t number = 0;
    std::uint32_t generation = 0;  // it is empty if this is not the table's
  };

  Slot& find(const Key& key) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = static_cast<std::size_t>(key.hash() >> 32) & mask;
    while (slots_[i].generation == generation_ && !(slots_[i].key == key)) i = (i + 1) & mask;
    return slots_[i];
  }

  void grow() {
    std::vector<Slot> old(slots_.size() * 2);
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.generation == generation_) find(slot.key) = slot;
    }
  }

  std::vector<Slot> slots_;
  std::size_t count_ = 0;
  std::uint32_t generation_ = 1;
};

/// A colour as a key.
struct ColourKey {
  std::uint32_t bits = 0;

  ColourKey() = default;
  explicit ColourKey(Rgba colour) { std::memcpy(&bits, &colour, sizeof bits); }

  friend bool operator==(ColourKey, ColourKey) = default;
  std::uint64_t hash() const { return bits * std::uint64_t{0x9e3779b97f4a7c15}; }
};

}  // namespace trapeze
