#include "server/base/seeded_hash.h"

#include <random>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace trapeze {
namespace {

std::uint64_t drawn_seed() {
  std::random_device device;
  return std::uint64_t{device()} << 32 | device();
}

}  // namespace

std::uint64_t seeded_hash(std::string_view text) {
  static const std::uint64_t seed = drawn_seed();
  return XXH3_64bits_withSeed(text.data(), text.size(), seed);
}

}  // namespace trapeze
