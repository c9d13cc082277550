#include "core/adapt/adaptable_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/graph/check_graph.h"
#include "core/sweep/graph_builder.h"
#include "tests/core/shapes/shapes.h"
#include "tests/sanitized.h"

namespace trapeze {
namespace {

constexpr double kAll = std::numeric_limits<double>::infinity();
constexpr unsigned kShapes = testing::kIsSanitized ? 100 : 350;

std::optional<TrapezoidalGraph> graph_of(Rings rings) {
  TrapezoidalGraph graph;
  GraphBuilder builder;
  if (!builder.build(rings, graph).built) return std::nullopt;
  return graph;
}

TrapezoidalGraph rebuilt(const TrapezoidalGraph& graph) {
  Rings rings = rings_of(graph);
  TrapezoidalGraph fresh;
  GraphBuilder builder;
  const BuildOutcome outcome = builder.build(rings, fresh);
  EXPECT_FALSE(outcome.noded) << "the rings that are left cross or touch";
  EXPECT_TRUE(outcome.built);
  return fresh;
}

TEST(AdaptableGraph, EveryRemovalLeavesTheMapOfTheRingsThatAreLeft) {
  for (unsigned seed = 0; seed < kShapes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto graph = graph_of(random_shape(seed));
    if (!graph) continue;
    EditLog log(*graph);
    PriorityStack stack;
    stack.assign(*graph, {});
    while (stack.remove_next(*graph, log)) {
      ASSERT_EQ(check_graph(*graph), "") << "after " << log.size() << " removals";
      if (rings_of(*graph).empty()) {
        ASSERT_EQ(graph->inside_nodes().size(), 0u);
      } else {
        ASSERT_EQ(plain_trapezoids(*graph), plain_trapezoids(rebuilt(*graph)))
            << "after " << log.size() << " removals";
      }
    }
  }
}

TEST(AdaptableGraph, SaysAtWhichTolerancesItIsAsItIs) {
  for (unsigned seed = 0; seed < kShapes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto graph = graph_of(random_shape(seed));
    if (!graph) continue;
    AdaptableGraph adaptable(*graph);
    EXPECT_TRUE(adaptable.unchanged().contains(0));
    for (const double epsilon : {0.0, 0.7, 12.0, 500.0, 12.0, 0.7}) {
      adaptable.adapt_to(epsilon);
      const AdaptableGraph::Unchanged unchanged = adaptable.unchanged();
      EXPECT_TRUE(unchanged.contains(epsilon));
      const TrapezoidalGraph before = adaptable.graph();
      const bool has_end = unchanged.up_to < kAll;
      adaptable.adapt_to(has_end ? unchanged.up_to : 1e12);
      EXPECT_EQ(adaptable.graph(), before);
      if (unchanged.above >= 0) {
        adaptable.adapt_to(unchanged.above);
        EXPECT_NE(adaptable.graph(), before);
      }
      if (has_end) {
        adaptable.adapt_to(std::nextafter(unchanged.up_to, kAll));
        EXPECT_NE(adaptable.graph(), before);
      }
    }
  }
}

TEST(AdaptableGraph, ForwardToNothingAndFullyBackIsTheSameGraph) {
  for (unsigned seed = 0; seed < kShapes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto graph = graph_of(random_shape(seed));
    if (!graph) continue;
    AdaptableGraph adaptable(*graph);
    adaptable.adapt_to(kAll);
    EXPECT_TRUE(adaptable.graph().inside_nodes().empty());
    adaptable.adapt_to(0);
    EXPECT_EQ(adaptable.graph(), *graph);
  }
}

TEST(AdaptableGraph, StateDependsOnTheToleranceOnly) {
  for (unsigned seed = 0; seed < 70; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto graph = graph_of(random_shape(seed));
    if (!graph) continue;
    AdaptableGraph wandering(*graph);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> exponent(-2, 14);
    for (int jump = 0; jump < 30; ++jump) {
      const double epsilon = jump % 7 == 6 ? 0 : std::exp2(exponent(random));
      wandering.adapt_to(epsilon);
      AdaptableGraph direct(*graph);
      direct.adapt_to(epsilon);
      ASSERT_EQ(wandering.graph(), direct.graph()) << "at " << epsilon;
    }
  }
}

TEST(AdaptableGraph, FastRemovalKeepsTheLinksWhole) {
  for (unsigned seed = 0; seed < kShapes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto graph = graph_of(random_shape(seed));
    if (!graph) continue;
    AdaptableGraph adaptable(*graph, {WeightRule::douglas_peucker, Topology::fast});
    adaptable.adapt_to(kAll);
    adaptable.adapt_to(0);
    EXPECT_EQ(adaptable.graph(), *graph);
  }
}

TEST(AdaptableGraph, RingsThatHookIntoEachOtherGoInTheEnd) {
  // Each ring has a corner in the bay of the other, so that all four corners with a finite weight
  // are blocked.
  const auto graph = graph_of(
      rings_from_text("3 0, 15 10, 0 16394, 2580 0; 5 3847, -256 -1, 2815 -32512, -2816 -2"));
  ASSERT_TRUE(graph);
  AdaptableGraph adaptable(*graph);
  adaptable.adapt_to(kAll);
  EXPECT_TRUE(adaptable.graph().inside_nodes().empty());
  adaptable.adapt_to(0);
  EXPECT_EQ(adaptable.graph(), *graph);
}

/// A straightforward Douglas-Peucker on one ring, with the anchors that the weights use: the
/// uppermost point and the point farthest from it.
class PlainDouglasPeucker {
 public:
  PlainDouglasPeucker(std::span<const Point> ring, double epsilon)
      : ring_(ring), epsilon_(epsilon) {
    keep_.assign(ring.size(), false);
    std::size_t top = 0;
    for (std::size_t i = 1; i < ring.size(); ++i) top = is_above(ring[i], ring[top]) ? i : top;
    const auto squared = [&](std::size_t i) {
      return std::pow(static_cast<double>(ring[i].x) - ring[top].x, 2) +
             std::pow(static_cast<double>(ring[i].y) - ring[top].y, 2);
    };
    std::size_t far = 0;
    for (std::size_t i = 1; i < ring.size(); ++i) {
      if (squared(i) > squared(far) || (squared(i) == squared(far) && is_above(ring[i], ring[far])))
        far = i;
    }
    keep_[top] = keep_[far] = true;
    split(top, far);
    split(far, top);
  }
  std::size_t kept() const {
    return static_cast<std::size_t>(std::count(keep_.begin(), keep_.end(), true));
  }

 private:
  void split(std::size_t a, std::size_t b) {
    double farthest = -1;
    std::vector<std::size_t> ties;
    std::vector<std::size_t> between;
    for (std::size_t i = (a + 1) % ring_.size(); i != b; i = (i + 1) % ring_.size())
      between.push_back(i);
    for (std::size_t k = 0; k < between.size(); ++k) {
      const double d = std::sqrt(squared_distance(ring_[between[k]], ring_[a], ring_[b]));
      if (d > farthest) ties.clear();
      farthest = std::max(farthest, d);
      if (d == farthest) ties.push_back(k);
    }
    if (between.empty() || farthest < epsilon_) return;
    // Among equals, the one nearest the middle, then the uppermost.
    const auto off_middle = [&](std::size_t k) { return std::max(k + 1, between.size() - k); };
    std::size_t best = ties[0];
    for (const std::size_t k : ties) {
      if (off_middle(k) < off_middle(best) || (off_middle(k) == off_middle(best) &&
                                               is_above(ring_[between[k]], ring_[between[best]]))) {
        best = k;
      }
    }
    keep_[between[best]] = true;
    split(a, between[best]);
    split(between[best], b);
  }

  std::span<const Point> ring_;
  double epsilon_;
  std::vector<bool> keep_;
};

TEST(AdaptableGraph, WeightsBelowATolerancesAreWhatDouglasPeuckerDrops) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto graph = graph_of(random_shape(seed));
    if (!graph) continue;
    const Rings rings = rings_of(*graph);
    VertexWeights weights;
    for (double epsilon = 0.3; epsilon < 1e5; epsilon *= 1.7) {
      for (std::size_t r = 0; r < rings.size(); ++r) {
        const auto w = weights.weigh(rings[r], WeightRule::douglas_peucker);
        const auto kept = std::count_if(w.begin(), w.end(), [&](double x) { return x >= epsilon; });
        EXPECT_EQ(static_cast<std::size_t>(kept), PlainDouglasPeucker(rings[r], epsilon).kept())
            << "ring " << r << " at " << epsilon;
      }
    }
  }
}

TEST(AdaptableGraph, EveryDroppedVertexIsWithinTheToleranceOfTheChordOverIt) {
  for (unsigned seed = 0; seed < 70; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto graph = graph_of(random_shape(seed));
    if (!graph) continue;
    AdaptableGraph adaptable(*graph);
    for (const double epsilon : {0.5, 3.0, 20.0, 150.0}) {
      adaptable.adapt_to(epsilon);
      for (std::size_t i = 0; i < graph->corners().size(); ++i) {
        const CornerId first(i);
        if (!adaptable.graph().corner(first).is_alive()) continue;
        const CornerId end = adaptable.graph().corner(first).next;
        const Point a = graph->point(graph->corner(first).vertex);
        const Point b = graph->point(graph->corner(end).vertex);
        for (CornerId c = graph->corner(first).next; c != end; c = graph->corner(c).next) {
          EXPECT_LE(std::sqrt(squared_distance(graph->point(graph->corner(c).vertex), a, b)),
                    epsilon * 1.0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace trapeze
