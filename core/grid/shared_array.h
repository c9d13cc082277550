// An array that grows at its end while others read its earlier content.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/grid/stored_array.h"

namespace trapeze {

/// One thread at a time appends. Any number of threads may read what was appended before they were
/// given the view.
template <typename T>
class SharedArray {
 public:
  SharedArray() : SharedArray(std::span<const T>()) {}
  /// With a copy of the items and room for more.
  explicit SharedArray(std::span<const T> items) { move_to_a_larger_one(items, 0); }

  std::size_t size() const { return items_->size(); }

  /// Items that others view stay where they are; the views must hold the owner().
  void append(std::span<const T> more) {
    if (items_->size() + more.size() > items_->capacity()) {
      move_to_a_larger_one(*items_, more.size());
    }
    items_->insert(items_->end(), more.begin(), more.end());
  }
  void append(std::size_t count, const T& item) { append(std::vector<T>(count, item)); }

  /// A view of the present content.
  StoredArray<T> view() const { return StoredArray<T>::looking_at(*items_); }
  std::shared_ptr<const void> owner() const { return items_; }

 private:
  // Unused capacity takes only address space, no memory.
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
