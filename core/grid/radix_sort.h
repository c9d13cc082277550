// Sorts long arrays by 64-bit keys, in time proportional to their length.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/for_each_in_parallel.h"
#include "core/grid/large_array.h"

namespace trapeze {

/// A key, and the index of the item to which it belongs.
struct KeyedIndex {
  std::uint64_t key = 0;
  std::uint32_t index = 0;

  friend auto operator<=>(const KeyedIndex&, const KeyedIndex&) = default;
};

/// Sorts a part of an array by key, see sort_by_key(). `scratch` has the same length.
inline void sort_part_by_key(std::span<KeyedIndex> items, std::span<KeyedIndex> scratch) {
  constexpr std::size_t kFew = 4096;  // that fit into the cache
  if (items.size() < kFew) return std::sort(items.begin(), items.end());
  constexpr unsigned kDigitBits = 11;
  constexpr unsigned kDigits = (64 + kDigitBits - 1) / kDigitBits;
  constexpr std::size_t kRadix = std::size_t{1} << kDigitBits;
  const auto digit = [](std::uint64_t key, unsigned d) {
    return static_cast<std::size_t>(key >> (d * kDigitBits)) & (kRadix - 1);
  };
  std::vector<std::array<std::size_t, kRadix>> counts(kDigits);
  for (const KeyedIndex& item : items) {
    for (unsigned d = 0; d < kDigits; ++d) ++counts[d][digit(item.key, d)];
  }
  std::span<KeyedIndex> from = items;
  std::span<KeyedIndex> to = scratch;
  for (unsigned d = 0; d < kDigits; ++d) {
    std::array<std::size_t, kRadix>& places = counts[d];
    if (places[digit(from.front().key, d)] == from.size()) continue;  // all have the same digit
    std::size_t place = 0;
    for (std::size_t& count : places) place += std::exchange(count, place);
    for (const KeyedIndex& item : from) to[places[digit(item.key, d)]++] = item;
    std::swap(from, to);
  }
  if (from.data() != items.data()) std::copy(from.begin(), from.end(), items.begin());
}

/// Sorts items that are in order of indices by key, then by index. `scratch` is resized to the same
/// length. Runs on up to `threads` threads.
inline void sort_by_key(LargeArray<KeyedIndex>& items, LargeArray<KeyedIndex>& scratch,
                        unsigned threads = 1) {
  constexpr std::size_t kFewest = 1 << 15;  // the minimum per thread
  const std::size_t count = items.size();
  scratch.resize(count);
  const std::size_t parts = std::clamp<std::size_t>(count / kFewest, 1, std::max(threads, 1u));
  const auto begin_of = [&](std::size_t part) { return count * part / parts; };
  for_each_in_parallel(parts, threads, [&](std::size_t i) {
    const std::size_t size = begin_of(i + 1) - begin_of(i);
    sort_part_by_key(std::span(items).subspan(begin_of(i), size),
                     std::span(scratch).subspan(begin_of(i), size));
  });
  if (parts == 1) return;
  // Each thread merges the items between two keys, which are taken from the first part.
  std::vector<std::vector<std::size_t>> bounds(parts + 1, std::vector<std::size_t>(parts));
  for (std::size_t p = 0; p < parts; ++p) bounds[0][p] = begin_of(p);
  for (std::size_t i = 1; i < parts; ++i) {
    const std::uint64_t key = items[begin_of(1) * i / parts].key;
    for (std::size_t p = 0; p < parts; ++p) {
      const auto part = std::span(items).subspan(begin_of(p), begin_of(p + 1) - begin_of(p));
      const auto bound = std::lower_bound(part.begin(), part.end(), key,
                                          [](const auto& item, auto k) { return item.key < k; });
      bounds[i][p] = begin_of(p) + static_cast<std::size_t>(bound - part.begin());
    }
  }
  for (std::size_t p = 0; p < parts; ++p) bounds[parts][p] = begin_of(p + 1);
  for_each_in_parallel(parts, threads, [&](std::size_t i) {
    std::vector<std::size_t> at = bounds[i];
    const std::vector<std::size_t>& ends = bounds[i + 1];
    std::size_t place = 0;
    for (std::size_t p = 0; p < parts; ++p) place += at[p] - begin_of(p);
    for (;;) {
      std::size_t least = parts;
      for (std::size_t p = 0; p < parts; ++p) {
        if (at[p] < ends[p] && (least == parts || items[at[p]].key < items[at[least]].key)) {
          least = p;
        }
      }
      if (least == parts) break;
      scratch[place++] = items[at[least]++];
    }
  });
  items.swap(scratch);
}

}  // namespace trapeze
