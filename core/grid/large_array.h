// Memory for arrays of many megabytes that are accessed all over: in huge pages, so that it is
// available after a few hundred page faults instead of a hundred thousand, and address translation
// is fast.
#pragma once

#include <cstddef>
#include <limits>
#include <new>
#include <vector>

namespace trapeze {

/// Like operator new, but large arrays are in huge pages where the system has them.
void* allocate_array(std::size_t bytes);
void free_array(void* memory, std::size_t bytes) noexcept;

template <class T>
struct ArrayAllocator {
  using value_type = T;

  ArrayAllocator() = default;
  template <class U>
  ArrayAllocator(const ArrayAllocator<U>&) noexcept {}  // NOLINT(google-explicit-constructor)

  T* allocate(std::size_t count) {
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(T)) {
      throw std::bad_array_new_length();
    }
    return static_cast<T*>(allocate_array(count * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t count) noexcept { free_array(memory, count * sizeof(T)); }

  friend bool operator==(const ArrayAllocator&, const ArrayAllocator&) { return true; }
};

/// A vector that may be large.
template <class T>
using LargeArray = std::vector<T, ArrayAllocator<T>>;

}  // namespace trapeze
