// The left-to-right order of the items that cross a sweep line: a linked list of slots with a treap
// over it (a search tree from left to right and a heap by random priority).
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace trapeze {

/// Holds its memory for reuse. Slots keep their numbers while others are inserted and removed.
/// Thread-safety: none.
template <class Item>
class SweepOrder {
 public:
  using Slot = std::uint32_t;
  static constexpr Slot kNoSlot = 0xffffffff;
  // The ends of the list, which are not in the tree.
  static constexpr Slot kFirst = 0;
  static constexpr Slot kLast = 1;

  /// Removes everything except the two ends.
  void clear() {
    entries_.clear();
    free_.clear();
    root_ = kNoSlot;
    random_ = 0x9e3779b9u;
    entries_.assign(2, Entry{});
    entries_[kFirst].next = kLast;
    entries_[kLast].prev = kFirst;
  }

  Item& operator[](Slot slot) { return entries_[slot].item; }
  const Item& operator[](Slot slot) const { return entries_[slot].item; }
  Slot prev(Slot slot) const { return entries_[slot].prev; }
  Slot next(Slot slot) const { return entries_[slot].next; }

  struct Location {
    Slot left = kFirst;  // the last slot left of the place; meaningless if `on` is one
    Slot on = kNoSlot;   // a slot at the place, if there is one
  };
  /// side_of(item) is positive if the place lies right of the item, negative if left, 0 if on it.
  template <class SideOf>
  Location locate(const SideOf& side_of) const {
    Location found;
    for (Slot slot = root_; slot != kNoSlot;) {
      const auto side = side_of(entries_[slot].item);
      if (side == 0) return {found.left, slot};
      if (side > 0) found.left = slot;
      slot = entries_[slot].child[side > 0];
    }
    return found;
  }

  Slot insert_after(Slot left, Item item) {
    Slot slot;
    if (free_.empty()) {
      slot = static_cast<Slot>(entries_.size());
      entries_.emplace_back();
    } else {
      slot = free_.back();
      free_.pop_back();
    }
    random_ ^= random_ << 13;
    random_ ^= random_ >> 17;
    random_ ^= random_ << 5;
    const Slot right = entries_[left].next;
    entries_[slot] = Entry{{kNoSlot, kNoSlot}, kNoSlot, random_, left, right, item};
    entries_[left].next = slot;
    entries_[right].prev = slot;
    // Of two neighbours in the order, one has no child on the side between them.
    if (root_ == kNoSlot) {
      root_ = slot;
    } else if (left != kFirst && entries_[left].child[1] == kNoSlot) {
      entries_[left].child[1] = slot;
      entries_[slot].parent = left;
    } else {
      entries_[right].child[0] = slot;
      entries_[slot].parent = right;
    }
    while (entries_[slot].parent != kNoSlot &&
           entries_[entries_[slot].parent].priority < entries_[slot].priority) {
      rotate_up(slot);
    }
    return slot;
  }

  void remove(Slot slot) {
    while (entries_[slot].child[0] != kNoSlot && entries_[slot].child[1] != kNoSlot) {
      const Slot a = entries_[slot].child[0];
      const Slot b = entries_[slot].child[1];
      rotate_up(entries_[a].priority > entries_[b].priority ? a : b);
    }
    const Slot child = entries_[slot].child[entries_[slot].child[0] == kNoSlot];
    replace_child(entries_[slot].parent, slot, child);
    entries_[entries_[slot].prev].next = entries_[slot].next;
    entries_[entries_[slot].next].prev = entries_[slot].prev;
    free_.push_back(slot);
  }

 private:
  struct Entry {
    Slot child[2] = {kNoSlot, kNoSlot};
    Slot parent = kNoSlot;
    std::uint32_t priority = 0;
    Slot prev = kNoSlot;
    Slot next = kNoSlot;
    Item item = {};
  };

  void replace_child(Slot parent, Slot old_child, Slot new_child) {
    if (parent == kNoSlot) {
      root_ = new_child;
    } else {
      entries_[parent].child[entries_[parent].child[1] == old_child] = new_child;
    }
    if (new_child != kNoSlot) entries_[new_child].parent = parent;
  }

  void rotate_up(Slot slot) {
    const Slot parent = entries_[slot].parent;
    const int side = entries_[parent].child[1] == slot;
    const Slot inner = entries_[slot].child[1 - side];
    replace_child(entries_[parent].parent, parent, slot);
    entries_[parent].child[side] = inner;
    if (inner != kNoSlot) entries_[inner].parent = parent;
    entries_[slot].child[1 - side] = parent;
    entries_[parent].parent = slot;
  }

  std::vector<Entry> entries_;
  std::vector<Slot> free_;
  Slot root_ = kNoSlot;
  std::uint32_t random_ = 1;
};

}  // namespace trapeze
