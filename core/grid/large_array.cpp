#include "core/grid/large_array.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <cstdint>

namespace trapeze {
namespace {

constexpr std::size_t kHugePage = std::size_t{1} << 21;
constexpr std::size_t kLarge = 2 * kHugePage;

}  // namespace

void* allocate_array(std::size_t bytes) {
  if (bytes < kLarge) return ::operator new(bytes);
  void* const memory = ::operator new (bytes, std::align_val_t{kHugePage});
#ifdef __linux__
  // Only whole pages: the rest of the last one may belong to others. The call may have no effect,
  // which is no error.
  madvise(memory, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);
#endif
  return memory;
}

void free_array(void* memory, std::size_t bytes) noexcept {
  if (bytes < kLarge) {
    ::operator delete(memory);
  } else {
    ::operator delete (memory, std::align_val_t{kHugePage});
  }
}

}  // namespace trapeze
