#include "core/io/load/huge_pages.h"

#include <sys/mman.h>

#include <cstdint>
#include <span>

#include "core/layer/layer_arrays.h"

#ifndef MADV_COLLAPSE
#define MADV_COLLAPSE 25  // since Linux 6.1; glibc defines it since 2.37
#endif

namespace trapeze {
namespace {

constexpr std::uintptr_t kPage = std::uintptr_t{1} << 21;  // bytes

template <typename T>
std::size_t collapse(std::span<const T> items) {
  const std::size_t before = -reinterpret_cast<std::uintptr_t>(items.data()) % kPage;
  if (items.size_bytes() < before + kPage) return 0;
  const std::size_t pages = (items.size_bytes() - before) / kPage;
  auto* const bytes = reinterpret_cast<std::byte*>(const_cast<T*>(items.data()));
  return madvise(bytes + before, pages * kPage, MADV_COLLAPSE) == 0 ? pages : 0;
}

}  // namespace

std::size_t move_to_huge_pages(const Layer& layer) {
  const LayerArrays arrays = arrays_of(layer);
  return collapse(arrays.vertices) + collapse(arrays.edges) + collapse(arrays.trapezoids) +
         collapse(arrays.lifespans) + collapse(arrays.feature_of) + collapse(arrays.polygon_index) +
         collapse(arrays.mote_index) + collapse(arrays.merged_mote_index);
}

}  // namespace trapeze
