// From bytes to features that share borders, overlap, touch and leave gaps, to coverages, through
// tolerances up and down: each is a map at every step, and the one built anew from its faces.
//
// Input: two bytes of flags, then points of four bytes (x and y of 16 bits); a point with x equal
// to the mark ends a ring, and the feature as well if its y is odd.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "core/adapt/history.h"
#include "core/borders/coverage_groups.h"
#include "core/borders/gap_closing.h"
#include "core/borders/regions.h"
#include "core/graph/check_graph.h"
#include "core/sweep/clean_rings.h"
#include "tests/fuzz/input_share.h"
#include "tests/fuzz/require.h"

namespace trapeze {
namespace {

using fuzzing::Checks;
using fuzzing::require;

constexpr std::int16_t kEndOfRing = 0x7fff;
constexpr std::size_t kMaxPoints = 300;  // the checks are slower than what they check
constexpr std::size_t kMaxFeatures = 12;

struct Input {
  CoverageMode mode = CoverageMode::automatic;
  double close_gaps = 0;
  int scale = 1;
  std::uint8_t seed = 0;
  Checks checks = Checks::all;
  std::vector<Rings> features;
};

std::vector<Rings> features_from(const std::uint8_t* data, std::size_t size, int scale) {
  std::vector<Rings> features(1);
  std::size_t points = 0;
  for (std::size_t i = 0; i + 4 <= size && points < kMaxPoints; i += 4, ++points) {
    const auto x = static_cast<std::int16_t>(data[i] | data[i + 1] << 8);
    const auto y = static_cast<std::int16_t>(data[i + 2] | data[i + 3] << 8);
    if (x != kEndOfRing) {
      features.back().points.push_back({x * scale, y * scale});
      continue;
    }
    features.back().close_ring();
    if (y % 2 != 0 && features.size() < kMaxFeatures) features.emplace_back();
  }
  features.back().close_ring();
  return features;
}

Input input_from(const std::uint8_t* data, std::size_t size) {
  Input input;
  input.mode = (data[0] & 1) != 0 ? CoverageMode::on : CoverageMode::automatic;
  // Small numbers bring points together; large ones use the whole grid.
  input.scale = (data[0] & 2) != 0 ? 32768 : 1;
  constexpr std::array<double, 4> kGaps = {0, 0.05, 1, kWidestGap};
  input.close_gaps = kGaps[data[0] >> 2 & 3];
  input.seed = data[1];
  input.checks = fuzzing::checks_of(fuzzing::hash_of(data, size));
  input.features = features_from(data + 2, size - 2, input.scale);
  for (Rings& rings : input.features) clean_rings(rings);
  return input;
}

void require_sound(const TrapezoidalGraph& graph) {
  const std::string violation = check_graph(graph);
  require(violation.empty(), violation);
}

/// Bounded places that nothing covers.
std::size_t count_holes(const TrapezoidalGraph& graph) {
  const Regions regions(graph);
  return static_cast<std::size_t>(std::count(regions.face.begin(), regions.face.end(), kOutside)) -
         1;
}

/// I11: the map is that of the faces that are left.
void require_rebuilt(const TrapezoidalGraph& graph) {
  const std::vector<Rings> rings = rings_of_faces(graph);
  std::vector<const Rings*> pointers;
  for (const Rings& of_face : rings) pointers.push_back(&of_face);
  TrapezoidalGraph fresh;
  const CoverageOutcome outcome =
      CoverageBuilder().build(pointers, {std::numeric_limits<double>::infinity(), 0}, fresh);
  require(!outcome.noded && outcome.overlaps.empty(), "I11: faces that are left cross or overlap");
  require(outcome.built == !graph.inside_nodes().empty(),
          "I11: faces are left, and no map of them");
  require(!outcome.built || plain_trapezoids(graph) == plain_trapezoids(fresh),
          "I11: the map is not that of the faces that are left");
}

void check_tolerances(const TrapezoidalGraph& original, const Input& input) {
  const std::size_t holes = count_holes(original);
  AdaptableGraph adaptable(original);
  std::uint32_t random = input.seed;
  const int jumps = fuzzing::jumps_of(input.checks);
  for (int jump = 0; jump < jumps; ++jump) {
    random = random * 1664525u + 1013904223u;
    const double share = static_cast<double>(random >> 20) / 4096;
    adaptable.adapt_to(input.scale * share * (1 << (random >> 8 & 15)));
    require_sound(adaptable.graph());
    require_rebuilt(adaptable.graph());
    require(count_holes(adaptable.graph()) <= holes, "there are holes that were not there");
  }
  adaptable.adapt_to(std::numeric_limits<double>::infinity());
  require(adaptable.graph().inside_nodes().empty(), "something never goes");
  adaptable.adapt_to(0);
  require(adaptable.graph() == original, "I12: forward and back is another graph");
}

void check_group(const std::vector<std::uint32_t>& group, const Input& input) {
  std::vector<const Rings*> members;
  std::vector<std::uint32_t> rows;
  for (const std::uint32_t i : group) {
    members.push_back(&input.features[i]);
    rows.push_back(i);
  }
  CoverageBuilder builder;
  TrapezoidalGraph graph;
  const Assembly assembly = assemble(members, input.mode, input.close_gaps, builder, graph);
  require(assembly.outcome.failure.empty(), assembly.outcome.failure);
  require(assembly.together.size() + assembly.apart.size() == group.size(),
          "a feature is lost, or there twice");
  if (assembly.together.empty()) return;
  require_sound(graph);
  if (is_made(input.checks, Checks::rebuilding)) require_rebuilt(graph);
  if (is_made(input.checks, Checks::tolerances)) check_tolerances(graph, input);
  if (!is_made(input.checks, Checks::history)) return;
  History history;
  HistoryRecorder().record(graph, assembly.outcome.faces.named(rows), {}, history);
}

void check(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return;
  Input input = input_from(data, size);
  if (input.close_gaps > 0) {
    std::vector<Rings*> pointers;
    for (Rings& rings : input.features) pointers.push_back(&rings);
    close_gaps(pointers, input.close_gaps);
  }
  std::vector<const Rings*> pointers;
  for (const Rings& rings : input.features) pointers.push_back(&rings);
  for (const auto& group : group_features(pointers, input.mode)) check_group(group, input);
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trapeze::check(data, size);
  return 0;
}
