#include "tests/fuzz/check_operators.h"

#include <limits>
#include <string>

#include "core/adapt/history_recorder.h"
#include "core/graph/check_graph.h"
#include "core/graph/edit_log.h"
#include "core/graph/generalization.h"
#include "core/graph/topological_consistency.h"
#include "core/sweep/graph_builder.h"
#include "tests/fuzz/require.h"

namespace trapeze::fuzzing {
namespace {

constexpr int kRemovals = 12;

class Random {
 public:
  explicit Random(std::uint32_t seed) : state_(seed + 1u) {}
  std::uint32_t next() {
    state_ = state_ * 1664525u + 1013904223u;
    return state_ >> 8;
  }

 private:
  std::uint32_t state_;
};

void require_sound(const TrapezoidalGraph& graph) {
  const std::string violation = check_graph(graph);
  require(violation.empty(), violation);
}

/// I11: the graph is that of the remaining rings.
void require_rebuilt(const TrapezoidalGraph& graph) {
  Rings rings = rings_of(graph);
  TrapezoidalGraph fresh;
  GraphBuilder builder;
  const bool is_built = builder.build(rings, fresh).built;
  require(is_built == !graph.inside_nodes().empty(), "I11: rings are left, and no graph of them");
  require(!is_built || plain_trapezoids(graph) == plain_trapezoids(fresh),
          "I11: the graph is not that of the rings that are left");
}

/// The first corner, from a random one on, that exists and may be removed; none if there is none.
struct Candidate {
  CornerId corner;
  Removal removal = Removal::blocked;
};
Candidate find_candidate(const TrapezoidalGraph& graph, Random& random) {
  const auto count = static_cast<std::uint32_t>(graph.corners().size());
  const std::uint32_t first = random.next() % count;
  for (std::uint32_t i = 0; i < count; ++i) {
    const CornerId corner{(first + i) % count};
    if (!graph.corner(corner).is_alive()) continue;
    const Removal removal = decide_removal(graph, corner, Topology::strict).removal;
    if (removal != Removal::blocked) return {corner, removal};
  }
  return {};
}

/// I10 and I11, in an order that no weights would produce.
void check_any_order(const TrapezoidalGraph& original, bool after_every_step, Random& random) {
  TrapezoidalGraph graph = original;
  EditLog log(graph);
  Generalization generalization(graph, log);
  for (int i = 0; i < kRemovals; ++i) {
    const Candidate candidate = find_candidate(graph, random);
    if (candidate.removal == Removal::blocked) break;
    generalization.remove(candidate.corner, candidate.removal);
    if (after_every_step) require_sound(graph);
  }
  require_sound(graph);
  require_rebuilt(graph);
  const TrapezoidalGraph coarse = graph;
  while (log.applied() > 0) log.revert();
  require(graph == original, "I10: what is taken back is not what was there");
  while (log.applied() < log.size()) log.apply();
  require(graph == coarse, "I10: applying again is not the same as applying");
}

/// I12.
void check_tolerances(const TrapezoidalGraph& original, const Operations& operations,
                      Random& random) {
  AdaptableGraph adaptable(original, operations.generalization);
  const int jumps = jumps_of(operations.checks);
  for (int jump = 0; jump < jumps; ++jump) {
    const double share = static_cast<double>(random.next() % 4096) / 4096;
    adaptable.adapt_to(operations.greatest_tolerance * share / (1 << (random.next() % 12)));
    if (operations.generalization.topology == Topology::strict) require_sound(adaptable.graph());
  }
  adaptable.adapt_to(std::numeric_limits<double>::infinity());
  require(adaptable.graph().inside_nodes().empty() ||
              operations.generalization.topology == Topology::fast,
          "something never goes");
  adaptable.adapt_to(0);
  require(adaptable.graph() == original, "I12: forward and back is another graph");
}

}  // namespace

void check_operators(Rings& rings, const Operations& operations) {
  GraphBuilder builder;
  TrapezoidalGraph graph;
  const BuildOutcome outcome = builder.build(rings, graph);
  require(outcome.failure.empty(), outcome.failure);
  if (!outcome.built) return;
  require_sound(graph);
  Random random(operations.seed);
  if (is_made(operations.checks, Checks::rebuilding))
    check_any_order(graph, operations.checks == Checks::all, random);
  if (is_made(operations.checks, Checks::tolerances)) check_tolerances(graph, operations, random);
  if (!is_made(operations.checks, Checks::history)) return;
  History history;
  HistoryRecorder().record(graph, operations.generalization, history);
}

}  // namespace trapeze::fuzzing
