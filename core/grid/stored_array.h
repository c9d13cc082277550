// An array that owns its items or is a view of items owned by others, such as a mapped file.
// Reading is the same in both cases.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace trapeze {

template <typename T>
class StoredArray {
 public:
  StoredArray() = default;
  /// Releases capacity that the items do not need.
  StoredArray(std::vector<T> items) : own_(std::move(items)) { shrink_to_fit(); }
  /// `items` must outlive the array.
  static StoredArray looking_at(std::span<const T> items) {
    StoredArray array;
    array.items_ = items;
    return array;
  }
  // Moving a vector does not move its items, so the view remains valid.
  StoredArray(StoredArray&& other) noexcept
      : own_(std::move(other.own_)), items_(std::exchange(other.items_, {})) {}
  StoredArray& operator=(StoredArray&& other) noexcept {
    own_ = std::move(other.own_);
    items_ = std::exchange(other.items_, {});
    return *this;
  }
  StoredArray(const StoredArray&) = delete;
  StoredArray& operator=(const StoredArray&) = delete;
  ~StoredArray() = default;

  std::size_t size() const { return items_.size(); }
  bool empty() const { return items_.empty(); }
  const T& operator[](std::size_t i) const { return items_[i]; }
  const T* data() const { return items_.data(); }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }

  /// From here on: an array that is a view copies its items first.
  void append(std::span<const T> more) {
    own_items();
    own_.insert(own_.end(), more.begin(), more.end());
    items_ = own_;
  }
  void push_back(const T& item) {
    own_items();
    own_.push_back(item);
    items_ = own_;
  }
  /// New items are T().
  void resize(std::size_t size) {
    own_items();
    own_.resize(size);
    items_ = own_;
  }
  /// `i` < size().
  void set(std::size_t i, const T& item) {
    own_items();
    own_[i] = item;
  }
  /// A copy that owns its items.
  StoredArray copy() const { return std::vector<T>(items_.begin(), items_.end()); }
  /// For changing the last item. Precondition: there is one.
  T& back() {
    own_items();
    return own_.back();
  }

  /// Releases capacity that the items do not need, because nothing more is appended.
  void shrink_to_fit() {
    if (own_.empty()) return;
    own_.shrink_to_fit();
    items_ = own_;
  }

  /// Bytes of memory, whether owned or viewed.
  std::size_t memory() const {
    return own_.empty() ? items_.size_bytes() : own_.capacity() * sizeof(T);
  }

 private:
  void own_items() {
    if (own_.size() == items_.size()) return;
    own_.assign(items_.begin(), items_.end());
    items_ = own_;
  }

  std::vector<T> own_;
  std::span<const T> items_;
};

}  // namespace trapeze
