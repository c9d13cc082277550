// A map with a memory budget: the least recently used entries are evicted.
//
// Thread-safety: one thread at a time.
#pragma once

#include <cassert>
#include <cstddef>
#include <functional>
#include <list>
#include <unordered_map>
#include <utility>

namespace trapeze {

template <typename Key, typename Value, typename Hash = std::hash<Key>>
class LruMap {
 public:
  /// `budget` is in bytes, as stated for each entry.
  explicit LruMap(std::size_t budget) : budget_(budget) {}

  /// Null if there is no such entry. A found entry becomes the most recently used.
  Value* find(const Key& key) {
    const auto found = by_key_.find(key);
    if (found == by_key_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return &found->second->value;
  }

  /// Adds an entry whose key is not in the map yet, and evicts others until it fits; it is kept
  /// even if it is larger than the budget. References to other values are invalid afterwards.
  Value& insert(const Key& key, Value value, std::size_t bytes) {
    assert(!by_key_.contains(key));
    entries_.push_front({key, std::move(value), bytes});
    try {
      by_key_.emplace(key, entries_.begin());
    } catch (...) {
      entries_.pop_front();  // otherwise its bytes, which are not counted yet, would be subtracted
      throw;
    }
    bytes_ += bytes;
    while (bytes_ > budget_ && entries_.size() > 1) remove_last();
    return entries_.front().value;
  }

  /// Does nothing if there is no such entry.
  void erase(const Key& key) {
    const auto found = by_key_.find(key);
    if (found == by_key_.end()) return;
    bytes_ -= found->second->bytes;
    entries_.erase(found->second);
    by_key_.erase(found);
  }

  std::size_t bytes() const { return bytes_; }
  std::size_t budget() const { return budget_; }

 private:
  struct Entry {
    Key key;
    Value value;
    std::size_t bytes;
  };

  void remove_last() {
    bytes_ -= entries_.back().bytes;
    by_key_.erase(entries_.back().key);
    entries_.pop_back();
  }

  std::size_t budget_;
  std::size_t bytes_ = 0;
  std::list<Entry> entries_;  // most recently used first
  std::unordered_map<Key, typename std::list<Entry>::iterator, Hash> by_key_;
};

}  // namespace trapeze
