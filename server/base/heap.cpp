#include "server/base/heap.h"

#include <malloc.h>

namespace trapeze {
namespace {

// The C library would raise this threshold to the size of the block freed last, up to 32 MB: arrays
// of layers would then be allocated among everything else, and leave permanent holes. Memory for
// drawing is usually smaller.
constexpr int kLargeArray = 1 << 20;  // bytes
// Once the threshold above is set, this one is no longer adapted either. It keeps memory for
// drawing, which is needed again immediately, also when a map fills a screen. Otherwise the kernel
// would have to find and clear the same pages again for every band.
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
