// Converts bytes to features that share borders, overlap, touch and leave gaps, builds coverages
// and adapts them to tolerances up and down. Each is a valid map at every step and equals the one
// rebuilt from its faces. The same applies with blocks: the void is filled in connected sets,
// between features of one class only, and no block is smaller than the features it is made of.
//
// Input: two bytes of flags, then points of four bytes (x and y of 16 bits). A point with x equal
// to the mark ends a ring, and the feature as well if its y is odd.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "core/adapt/history_recorder.h"
#include "core/borders/coverage_groups.h"
#include "core/borders/gap_closing.h"
#include "core/borders/merging.h"
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
constexpr std::size_t kMaxPoints = 300;  // the checks are slower than the checked code
constexpr std::size_t kMaxFeatures = 12;

struct Input {
  CoverageMode mode = CoverageMode::automatic;
  double close_gaps = 0;
  Merging merging;
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
  // A small scale brings points together; a large one uses the whole grid.
  input.scale = (data[0] & 2) != 0 ? 32768 : 1;
  constexpr std::array<double, 4> kGaps = {0, 0.05, 1, kWidestGap};
  input.close_gaps = kGaps[data[0] >> 2 & 3];
  constexpr std::array<double, 4> kRatios = {0, 0.5, 4, 64};
  input.merging.ratio = kRatios[data[0] >> 4 & 3];
  input.seed = data[1];
  input.checks = fuzzing::checks_of(fuzzing::hash_of(data, size));
  input.features = features_from(data + 2, size - 2, input.scale);
  for (Rings& rings : input.features) clean_rings(rings);
  for (std::uint32_t i = 0; i < input.features.size() && (data[0] & 64) != 0; ++i) {
    input.merging.classes.push_back(i % 2);
  }
  return input;
}

void require_sound(const TrapezoidalGraph& graph) {
  const std::string violation = check_graph(graph);
  require(violation.empty(), violation);
}

/// Bounded regions that no feature covers.
std::size_t count_holes(const TrapezoidalGraph& graph) {
  const Regions regions(graph);
  return static_cast<std::size_t>(std::count(regions.face.begin(), regions.face.end(), kOutside)) -
         1;
}

/// I11: the map is that of the remaining faces.
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

/// `plan` is null if there are no blocks.
void check_tolerances(const TrapezoidalGraph& original, const Input& input, const MergePlan* plan) {
  const std::size_t holes = count_holes(original);
  AdaptableGraph adaptable(original, {}, plan);
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
  for (const NodeId n : adaptable.graph().inside_nodes()) {
    const FaceId face = adaptable.graph().face(adaptable.graph().node(n));
    require(plan != nullptr && plan->is_void(face), "something never goes");
  }
  adaptable.adapt_to(0);
  require(adaptable.graph() == original, "I12: forward and back is another graph");
}

/// The area filled at a distance is a set that ends at sides no longer than that. Returns twice the
/// area that is ever filled, if there is a mesh.
std::optional<Int128> check_void(const TrapezoidalGraph& graph,
                                 std::span<const std::uint32_t> class_of_face) {
  VoidMesh mesh(graph);
  if (!mesh.has_failed()) divide_walls_for_bridges(mesh, graph, class_of_face);
  if (mesh.has_failed()) return std::nullopt;
  const std::vector<double> distances = distances_to_fill(mesh, graph, class_of_face);
  Int128 filled = 0;
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.is_beyond(t)) continue;
    const std::int64_t doubled =
        orientation(mesh.corner(3 * t), mesh.corner(3 * t + 1), mesh.corner(3 * t + 2));
    require(doubled > 0, "a triangle of the void is turned over");
    if (distances[t] > kWidestBridge) continue;
    filled += doubled;
    for (VoidMesh::HalfEdge h = 3 * t; h < 3 * t + 3; ++h) {
      if (mesh.is_wall(h) || mesh.length(h) <= distances[t]) continue;
      const double beyond = distances[VoidMesh::triangle_of(mesh.twin(h))];
      require(beyond <= distances[t], "what is filled ends at a side that is longer");
    }
  }
  return filled;
}

/// Features beside a piece of the void all have its class.
void check_pieces(const TrapezoidalGraph& graph, const MergePlan& plan) {
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const Edge& edge = graph.edge(EdgeId(i));
    if (graph.is_frame(EdgeId(i))) continue;
    for (const Side s : {kLeft, kRight}) {
      const FaceId beyond = edge.face[opposite(s)];
      if (!plan.is_piece(edge.face[s]) || plan.is_void(beyond)) continue;
      require(plan.are_of_one_class(edge.face[s], beyond), "a piece is beside another class");
    }
  }
  for (const double due : plan.due) {
    require(due >= 0 && due * plan.ratio <= kWidestBridge * (1 + 1e-9), "a piece is too wide");
  }
}

/// Twice the area of features, or of pieces of the void.
Int128 doubled_area(const TrapezoidalGraph& graph, const MergePlan& plan, bool of_pieces) {
  const std::vector<Int128> areas = graph.doubled_areas();
  Int128 sum = 0;
  for (FaceId face = 1; face < areas.size(); ++face) {
    if (plan.is_piece(face) == of_pieces) sum += areas[face];
  }
  return sum;
}

/// Features that become a block lose no area.
void check_steps(const TrapezoidalGraph& original, const MergePlan& plan) {
  TrapezoidalGraph graph = original;
  EditLog log(graph);
  PriorityStack stack;
  stack.assign(graph, {}, 1, &plan);
  Int128 before = doubled_area(graph, plan, false);
  while (stack.remove_next(graph, log)) {
    const Int128 now = doubled_area(graph, plan, false);
    const bool is_block =
        stack.last_removal() == Removal::region && stack.last_block_size().has_value();
    require(!is_block || now >= before, "a block is smaller than what it is made of");
    before = now;
  }
}

/// Checks the blocks of the features of `graph`.
void check_blocks(const std::vector<const Rings*>& members, const Merging& merging,
                  const CoverageOutcome& outcome, const TrapezoidalGraph& graph,
                  const Input& input) {
  CoverageBuilder builder;
  TrapezoidalGraph plain;
  const FaceFeatures faces =
      assemble(members, CoverageMode::on, input.close_gaps, builder, plain).outcome.faces;
  const std::optional<Int128> filled = check_void(plain, classes_of_faces(faces, merging));
  require(!filled || (*filled > 0) == (outcome.plan && !outcome.plan->due.empty()),
          "there is no plan of what is filled");
  if (!outcome.plan) return;
  require(filled == doubled_area(graph, *outcome.plan, true), "pieces are not what is filled");
  check_pieces(graph, *outcome.plan);
  if (is_made(input.checks, Checks::tolerances)) check_steps(graph, *outcome.plan);
}

void check_group(const std::vector<std::uint32_t>& group, const Input& input) {
  std::vector<const Rings*> members;
  std::vector<std::uint32_t> rows;
  for (const std::uint32_t i : group) {
    members.push_back(&input.features[i]);
    rows.push_back(i);
  }
  Merging merging{input.merging.ratio};
  for (const std::uint32_t i : group) {
    if (!input.merging.classes.empty()) merging.classes.push_back(input.merging.classes[i]);
  }
  CoverageBuilder builder;
  TrapezoidalGraph graph;
  const Assembly assembly =
      assemble(members, input.mode, input.close_gaps, builder, graph, nullptr, 1, merging);
  require(assembly.outcome.failure.empty(), assembly.outcome.failure);
  require(assembly.together.size() + assembly.apart.size() == group.size(),
          "a feature is lost, or there twice");
  if (assembly.together.empty()) return;
  require_sound(graph);
  if (is_made(input.checks, Checks::rebuilding)) require_rebuilt(graph);
  const MergePlan* plan = assembly.outcome.plan ? &*assembly.outcome.plan : nullptr;
  if (merging.ratio > 0) check_blocks(members, merging, assembly.outcome, graph, input);
  if (is_made(input.checks, Checks::tolerances)) check_tolerances(graph, input, plan);
  if (!is_made(input.checks, Checks::history)) return;
  History history;
  HistoryRecorder().record(graph, assembly.outcome.faces.named(rows), {}, history, nullptr, 1,
                           plan);
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
  const auto groups =
      input.merging.ratio > 0 ? group_for_blocks(pointers) : group_features(pointers, input.mode);
  for (const auto& group : groups) check_group(group, input);
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trapeze::check(data, size);
  return 0;
}
