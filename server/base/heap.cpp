#include "server/base/heap.h"

#include <malloc.h>

namespace trapeze {
namespace {

// The C library would raise this to the size of what was freed last, up to 32 MB: arrays of layers
// would then lie among all else, and leave holes that stay. What is drawn is mostly smaller.
constexpr int kLargeArray = 1 << 20;  // bytes
// Once the above is set, this is no longer adapted either. It is room for what is drawn, which is
// needed again at once: of a map that fills a screen, too, for which the kernel would otherwise
// find and clear the same pages anew at every band.
constexpr int kKeptAtTheEnd = 16 << 20;  // bytes

}  // namespace

void return_large_arrays() {
  mallopt(M_MMAP_THRESHOLD, kLargeArray);
  mallopt(M_TRIM_THRESHOLD, kKeptAtTheEnd);
}

void return_free_memory() {
  malloc_trim(0);
}

}  // namespace trapeze
