// From bytes to rings to a graph, through any removals and back: the invariants hold at every step.
//
// Input: two bytes of flags, then points of four bytes (x and y of 16 bits); a point with x equal to
// the mark ends a ring.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

#include "core/adaptable_graph.h"
#include "core/check_graph.h"
#include "core/graph_builder.h"
#include "core/history.h"

namespace trapeze {
namespace {

constexpr std::int16_t kEndOfRing = 0x7fff;
constexpr std::size_t kMaxPoints = 400;  // the checks are slower than what they check

void require(bool condition, const std::string& words) {
  if (condition) return;
  std::fprintf(stderr, "%s\n", words.c_str());
  std::abort();
}

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
  // Small numbers bring points together; large ones use the whole grid.
  const int scale = (data[0] & 1) != 0 ? 32768 : 1;
  const Topology topology = (data[0] & 2) != 0 ? Topology::fast : Topology::strict;
  const auto weights = static_cast<WeightRule>((data[0] >> 2) % 3);
  Rings rings = rings_from(data + 2, size - 2, scale);
  GraphBuilder builder;
  TrapezoidalGraph graph;
  const BuildOutcome outcome = builder.build(rings, graph);
  require(outcome.failure.empty(), outcome.failure);
  if (!outcome.built) return;
  require(check_graph(graph).empty(), check_graph(graph));

  AdaptableGraph adaptable(graph, {weights, topology});
  std::uint32_t random = data[1] + 1u;
  for (int jump = 0; jump < 8; ++jump) {
    random = random * 1664525u + 1013904223u;
    adaptable.adapt_to(static_cast<double>(random >> 16) * scale / (1 << (random % 12)));
    if (topology == Topology::strict) {
      require(check_graph(adaptable.graph()).empty(), check_graph(adaptable.graph()));
    }
  }
  adaptable.adapt_to(std::numeric_limits<double>::infinity());
  adaptable.adapt_to(0);
  require(adaptable.graph() == graph, "forward and back is another graph");

  History history;
  HistoryRecorder().record(graph, {weights, topology}, history);
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trapeze::check(data, size);
  return 0;
}
