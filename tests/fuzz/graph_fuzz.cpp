// Converts bytes to rings, builds their graph, applies any removals and reverts them: the
// invariants hold at every step.
//
// Input: two bytes of flags, then points of four bytes (x and y of 16 bits). A point with x equal
// to the mark ends a ring.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/check_operators.h"
#include "tests/fuzz/input_share.h"

namespace trapeze {
namespace {

constexpr std::int16_t kEndOfRing = 0x7fff;
constexpr std::size_t kMaxPoints = 400;  // the checks are slower than the checked code

Rings rings_from(const std::uint8_t* data, std::size_t size, int scale) {
  Rings rings;
  for (std::size_t i = 0; i + 4 <= size && rings.points.size() < kMaxPoints; i += 4) {
    const auto x = static_cast<std::int16_t>(data[i] | data[i + 1] << 8);
    const auto y = static_cast<std::int16_t>(data[i + 2] | data[i + 3] << 8);
    if (x == kEndOfRing) {
      rings.close_ring();
    } else {
      rings.points.push_back({x * scale, y * scale});
    }
  }
  rings.close_ring();
  return rings;
}

void check(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return;
  // A small scale brings points together; a large one uses the whole grid.
  const int scale = (data[0] & 1) != 0 ? 32768 : 1;
  fuzzing::Operations operations;
  operations.generalization.topology = (data[0] & 2) != 0 ? Topology::fast : Topology::strict;
  operations.generalization.weights = static_cast<WeightRule>((data[0] >> 2) % 4);
  operations.seed = data[1];
  operations.greatest_tolerance *= scale;
  operations.checks = fuzzing::checks_of(fuzzing::hash_of(data, size));
  Rings rings = rings_from(data + 2, size - 2, scale);
  fuzzing::check_operators(rings, operations);
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trapeze::check(data, size);
  return 0;
}
