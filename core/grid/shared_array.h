// An array that grows at its end while others look at what there was before.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/grid/stored_array.h"

namespace trapeze {

/// One thread at a time appends; any number may read what had been appended before they were told.
template <typename T>
class SharedArray {
 public:
  SharedArray() : SharedArray(std::span<const T>()) {}
  /// With a copy of the items, and room for more.
  explicit SharedArray(std::span<const T> items) { move_to_a_larger_one(items, 0); }

  std::size_t size() const { return items_->size(); }

  /// Items that others look at stay where they are; those who do must hold their owner().
  void append(std::span<const T> more) {
    if (items_->size() + more.size() > items_->capacity()) {
      move_to_a_larger_one(*items_, more.size());
    }
    items_->insert(items_->end(), more.begin(), more.end());
  }
  void append(std::size_t count, const T& item) { append(std::vector<T>(count, item)); }

  /// Of what there is now.
  StoredArray<T> view() const { return StoredArray<T>::looking_at(*items_); }
  std::shared_ptr<const void> owner() const { return items_; }

 private:
  // Room that is not used yet takes no memory but addresses.
  void move_to_a_larger_one(std::span<const T> items, std::size_t more) {
    constexpr std::size_t kLeastRoom = 1024;
    auto larger = std::make_shared<std::vector<T>>();
    larger->reserve(items.size() + items.size() / 4 + more + kLeastRoom);
    larger->assign(items.begin(), items.end());
    items_ = std::move(larger);
  }

  std::shared_ptr<std::vector<T>> items_;
};

}  // namespace trapeze
