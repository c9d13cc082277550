// The generalization operators, one by one: every prototype of the paper's Figures 4 and 5, and the
// additional cases of a graph with an outside, vertices of the same y and touching rings.
//
// Trapezoids are written "A-B AC|DB": top and bottom vertex, left and right edge. The paper draws
// trapezoids before and after, and so do these tests. Each removal is also checked for the general
// invariants: the graph is valid and is that of the remaining rings, revert restores the previous
// graph, and apply the new one.
#include "core/graph/generalization.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "tests/core/shapes/named_polygon.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

using Names = std::vector<std::string>;

/// A polygon from which vertices are removed; `inside()` returns its current trapezoids.
class Editor : public NamedPolygon {
 public:
  explicit Editor(const std::string& text) : NamedPolygon(text), log_(graph) {}

  Decision decide(char vertex, char other_of_loop = 0, Topology topology = Topology::strict) {
    return decide_removal(graph, corner(vertex, other_of_loop), topology);
  }

  /// Removes the vertex, from the loop that contains `other_of_loop` if one is named, and checks
  /// the invariants of every removal.
  void remove(char vertex, Removal wanted, char other_of_loop = 0) {
    const Decision decision = decide(vertex, other_of_loop);
    ASSERT_EQ(decision.removal, wanted) << vertex;
    const TrapezoidalGraph fine = graph;
    Generalization(graph, log_).remove(corner(vertex, other_of_loop), decision.removal);
    const TrapezoidalGraph coarse = graph;
    EXPECT_EQ(check_graph(graph), "");
    expect_equal_to_rebuilt();
    log_.revert();
    EXPECT_EQ(graph, fine) << "revert is not the inverse of apply";
    log_.apply();
    EXPECT_EQ(graph, coarse) << "applying again is not the same as applying";
  }

 private:
  void expect_equal_to_rebuilt() const {
    Rings rings = rings_of(graph);
    if (rings.empty()) {
      EXPECT_TRUE(graph.inside_nodes().empty());
      return;
    }
    TrapezoidalGraph rebuilt;
    const BuildOutcome outcome = GraphBuilder().build(rings, rebuilt);
    EXPECT_TRUE(outcome.built);
    EXPECT_FALSE(outcome.noded) << "the rings that are left cross or overlap";
    EXPECT_EQ(plain_trapezoids(graph), plain_trapezoids(rebuilt));
  }

  EditLog log_;
};

// ---- Figure 4: vertical generalization ----

// The tip of a polygon is removed with its vertex V. The trapezoid below keeps its height: its top
// side, which had two vertices A and B, was that of the tip and is now the boundary.
//
//            V
//          .' '.
//        A-------B                A-------B
//       /         \      =>      /         \        .
//      D-----------'            D-----------'
//       '----------C             '----------C
TEST(Figure4, a_EliminationOfTheTipAtTheTop) {
  Editor p("V 50 0, B 80 20, C 90 70, D 10 60, A 20 20");
  ASSERT_EQ(p.inside(), (Names{"V-A VA|VB", "A-B AD|VB", "B-D AD|BC", "D-C DC|BC"}));
  p.remove('V', Removal::extremum);
  EXPECT_EQ(p.inside(), (Names{"A-B AD|AB", "B-D AD|BC", "D-C DC|BC"}));
}

// Two trapezoids that share the line through V, its only vertex, become one.
//
//      A---.                    A---.
//      |    '-B                 |    '-B
//      | T1  |                  |      |
//      V-----|         =>       |  T   |
//       \ T2 |                  |      |
//        D---C                  D------C
TEST(Figure4, b_MergingAtAOneVertexSide) {
  Editor p("A 10 0, B 90 10, C 92 81, D 12 80, V 8 40");
  ASSERT_EQ(p.inside(), (Names{"A-B AV|AB", "B-V AV|BC", "V-D VD|BC", "D-C DC|BC"}));
  p.remove('V', Removal::regular);
  EXPECT_EQ(p.inside(), (Names{"A-B AD|AB", "B-D AD|BC", "D-C DC|BC"}));
}

// The same at a side with two vertices, both of which are removed. V-W, without height, is the side
// itself.
//
//      A---.                    A---.
//      |    '-B                 |    '-B
//      | T1  |                  |      |
//      V-----W         =>       |  T   |
//       \ T2 |                  |      |
//        D---C                  D------C
TEST(Figure4, b_MergingAtATwoVertexSideOfWhichBothGo) {
  Editor p("A 10 0, B 90 10, W 95 40, C 92 81, D 12 80, V 8 40");
  ASSERT_EQ(p.inside(), (Names{"A-B AV|AB", "B-V AV|BW", "V-W VD|BW", "W-D VD|WC", "D-C DC|WC"}));
  p.remove('V', Removal::regular);
  p.remove('W', Removal::regular);
  EXPECT_EQ(p.inside(), (Names{"A-B AD|AB", "B-D AD|BC", "D-C DC|BC"}));
}

//      D-----------.            D-----------.
//       \           C            \           C
//        \         /     =>       \         /
//         A-------B                A-------B
//          '.   .'
//            'V'
TEST(Figure4, c_EliminationOfTheTipAtTheBottom) {
  Editor p("D 10 0, C 90 10, B 80 50, V 50 70, A 20 50");
  ASSERT_EQ(p.inside(), (Names{"D-C DA|DC", "C-A DA|CB", "A-B AV|CB", "B-V AV|BV"}));
  p.remove('V', Removal::extremum);
  EXPECT_EQ(p.inside(), (Names{"D-C DA|DC", "C-A DA|CB", "A-B AB|CB"}));
}

// The neighbours of V have different y: the tip is removed, and the trapezoid below it, whose top
// side ran from A to the edge VB, becomes a triangle with its tip at A.
//
//           V
//          / \                                      .
//         A---\                   A
//        / \ T \         =>      / '-.
//       /   \   \               /  T  '-.
//      D-----'--B              D---------B
//       '------C                '------C
TEST(Figure4, d_DegenerationUnderATipAtTheTop) {
  Editor p("V 50 0, B 90 40, C 80 80, D 10 70, A 30 20");
  ASSERT_EQ(p.inside(), (Names{"V-A VA|VB", "A-B AD|VB", "B-D AD|BC", "D-C DC|BC"}));
  p.remove('V', Removal::extremum);
  EXPECT_EQ(p.inside(), (Names{"A-B AD|AB", "B-D AD|BC", "D-C DC|BC"}));
  EXPECT_EQ(p.name(p.graph.starting_node()), "A-B");
}

// A side with two vertices, V and W, shared by the trapezoids above and below it; W is kept. Both
// keep their height and get the edge AD: an adjustment. V-W without height no longer exists.
//
//        A--B                     A--B
//       / T1 \                    |T1 \              .
//      V------W        =>         |----W
//       \ T2 /                    |T2 /
//        D--C                     D--C
TEST(Figure4, e_AdjustmentAtATwoVertexSideOfWhichOneStays) {
  Editor p("A 30 0, B 60 10, W 90 40, C 62 81, D 32 80, V 2 40");
  ASSERT_EQ(p.inside(), (Names{"A-B AV|AB", "B-V AV|BW", "V-W VD|BW", "W-D VD|WC", "D-C DC|WC"}));
  p.remove('V', Removal::regular);
  EXPECT_EQ(p.inside(), (Names{"A-B AD|AB", "B-W AD|BW", "W-D AD|WC", "D-C DC|WC"}));
}

//      D------C                 D------C
//     B--.---/                 B---.  /
//      \  T / A       =>        '-. T/
//       \  / /                     '-A
//        '-V
TEST(Figure4, f_DegenerationAboveATipAtTheBottom) {
  Editor p("D 10 0, C 80 10, A 70 60, V 50 80, B 5 40");
  ASSERT_EQ(p.inside(), (Names{"D-C DB|DC", "C-B DB|CA", "B-A BV|CA", "A-V BV|AV"}));
  p.remove('V', Removal::extremum);
  EXPECT_EQ(p.inside(), (Names{"D-C DB|DC", "C-B DB|CA", "B-A BA|CA"}));
}

// The top side of a polygon with its two vertices V and W, not shared; W is kept. The
// trapezoid below collapses into a triangle with its tip at W.
//
//      V------W                       W
//     /   T    \                   .-' \             .
//    A----------\      =>        A------\            .
//     \          B                \      B
//      '----C---'                  '-C--'
TEST(Figure4, g_DegenerationAtATwoVertexSideOfWhichOneStays) {
  Editor p("V 20 0, W 80 0, B 98 50, C 50 90, A 2 40");
  ASSERT_EQ(p.inside(), (Names{"V-W VA|VW", "W-A VA|WB", "A-B AC|WB", "B-C AC|BC"}));
  p.remove('V', Removal::extremum);
  EXPECT_EQ(p.inside(), (Names{"W-A WA|WB", "A-B AC|WB", "B-C AC|BC"}));
}

// The same with both vertices removed: first the trapezoid collapses, then the triangle is
// eliminated.
//
//      V------W
//     /   T    \                                     .
//    A----------\      =>     A---.
//     \          B             \   '---B
//      '----C---'               '--C--'
TEST(Figure4, h_EliminationAtATwoVertexSideOfWhichBothGo) {
  Editor p("V 20 0, W 80 0, B 98 50, C 50 90, A 2 40");
  p.remove('V', Removal::extremum);
  p.remove('W', Removal::extremum);
  EXPECT_EQ(p.inside(), (Names{"A-B AC|AB", "B-C AC|BC"}));
}

// ---- Figure 5: horizontal generalization ----

// Below the division at V hang two triangles side by side, with tips A and B of the same y. Without
// V they are one trapezoid. As the line through V is removed too, it merges with the trapezoid
// above.
//
//      C-----------D              C-----------D
//       \    T1   /                \         /
//        \---V---/       =>         \   T   /
//         \T2^T3/                    A-----B
//          A   B
TEST(Figure5, a_MergingOfTwoTrianglesUnderADivision) {
  Editor p("C 0 0, D 100 1, B 70 60, V 50 30, A 30 60");
  ASSERT_EQ(p.inside(), (Names{"C-D CA|CD", "D-V CA|DB", "V-A CA|VA", "V-B VB|DB"}));
  p.remove('V', Removal::extremum);
  EXPECT_EQ(p.inside(), (Names{"C-D CA|CD", "D-A CA|DB", "A-B AB|DB"}));
}

//          A   B                     A-----B
//         /T1vT2\                   /       \        .
//        /---V---\       =>        /    T    \       .
//       /   T3    \               /           \      .
//      C-----------D              C-----------D
TEST(Figure5, b_MergingOfTwoTrianglesAboveAJoin) {
  Editor p("A 30 0, V 50 30, B 70 0, D 100 61, C 0 60");
  ASSERT_EQ(p.inside(), (Names{"A-V AC|AV", "B-V BV|BD", "V-C AC|BD", "C-D CD|BD"}));
  p.remove('V', Removal::extremum);
  EXPECT_EQ(p.inside(), (Names{"A-B AC|AB", "B-C AC|BD", "C-D CD|BD"}));
}

// The legs continue below A, the nearer neighbour of V: the division moves from V to A. The
// trapezoid above reaches down to A's level; those of the legs get its level and, on the right, the
// edge AB.
//
//      C-----------D              C-----------D
//      |    T1     |              |           |
//      |-----V-----|              |    T1     |
//      | T2 / \ T3 |      =>      |           |
//      |--A/   \   |              |--A--------|
//      |T4|     \  |              |T4|'-. T3  |
//      E--F      B-G              E--F   '-B--G
TEST(Figure5, c_AdjustmentMovesADivisionToTheNearerNeighbour) {
  Editor p("C 0 0, D 100 1, G 101 101, B 80 90, V 50 20, A 25 60, F 26 100, E 1 99");
  ASSERT_EQ(p.inside(), (Names{"C-D CE|CD", "D-V CE|DG", "V-A CE|VA", "V-B VB|DG", "A-E CE|AF",
                               "B-G BG|DG", "E-F EF|AF"}));
  p.remove('V', Removal::extremum);
  EXPECT_EQ(p.inside(),
            (Names{"C-D CE|CD", "D-A CE|DG", "A-E CE|AF", "A-B AB|DG", "B-G BG|DG", "E-F EF|AF"}));
}

//      E--F      B-G              E--F   .-B--G
//      |T4|     /  |              |T4|.-' T3  |
//      |--A\   /   |              |--A--------|
//      | T2 \ / T3 |      =>      |           |
//      |-----V-----|              |    T1     |
//      |    T1     |              |           |
//      C-----------D              C-----------D
TEST(Figure5, d_AdjustmentMovesAJoinToTheNearerNeighbour) {
  Editor p("E 1 0, F 26 1, A 25 40, V 50 80, B 80 10, G 101 -1, D 100 101, C 0 100");
  ASSERT_EQ(p.inside(), (Names{"G-B GB|GD", "E-F EC|EF", "F-A EC|FA", "B-V BV|GD", "A-V EC|AV",
                               "V-C EC|GD", "C-D CD|GD"}));
  p.remove('V', Removal::extremum);
  EXPECT_EQ(p.inside(),
            (Names{"G-B GB|GD", "E-F EC|EF", "F-A EC|FA", "B-A BA|GD", "A-C EC|GD", "C-D CD|GD"}));
}

// ---- How a vertex relates to the rest of the boundary ----

// A hole H begins at V, where the shell turns inwards. V is removed from the shell, but H still
// holds the line there: the two trapezoids on the hole's side are linked to it and not merged with
// each other.
//
//    A-----------C            A-----------C
//     \          |            |           |
//      V___      |            |  V___     |
//      |\__H     |     =>     |  \__H     |
//      / \_I     |            |   \_I     |
//     B----------D            B-----------D
TEST(TouchingRings, AVertexGoesFromOneRingAndStaysInTheOther) {
  Editor p("A 0 0, C 100 1, D 101 101, B 1 100, V 20 50; V 20 50, H 60 45, I 61 60");
  p.remove('V', Removal::regular, 'A');
  EXPECT_EQ(p.inside(), (Names{"A-C AB|AC", "C-H AB|CD", "H-V AB|HV", "H-I HI|CD", "V-I AB|VI",
                               "I-B AB|CD", "B-D BD|CD"}));
  EXPECT_EQ(rings_of(p.graph).size(), 2u);
}

// The shell's corner at V sticks out, and the hole lies in the wedge that would be cut off.
TEST(TouchingRings, AVertexStaysIfAnotherRingLeavesItInsideTheWedge) {
  Editor p("A 20 0, C 100 1, D 101 101, B 21 100, V 0 50; V 0 50, H 60 45, I 61 60");
  const Decision decision = p.decide('V', 'A');
  EXPECT_EQ(decision.removal, Removal::blocked);
  EXPECT_EQ(p.name(decision.blocker), "V");
}

// A, V and B are collinear: the hole's corner would end up on the edge AB.
TEST(TouchingRings, AVertexInLineWithItsNeighboursStaysWhileAnotherRingTouchesIt) {
  Editor p("A 0 0, C 100 1, D 101 101, B 0 100, V 0 50; V 0 50, H 60 45, I 61 60");
  const Decision decision = p.decide('V', 'A');
  EXPECT_EQ(decision.removal, Removal::blocked);
  EXPECT_EQ(p.name(decision.blocker), "V");
  p.remove('V', Removal::loop, 'H');
  p.remove('V', Removal::regular, 'A');
}

// The chord A-B is already an edge of another ring; without V there would be two such edges.
//
//       A---.                 A---.
//      /| \  '.              /|    '.
//     L |  V  C      =>     (once A B L has gone)
//      \| /  .'               |     .'
//       B---'                 B---'
TEST(TouchingRings, AVertexStaysWhileItsNeighboursAreJoinedByAnEdgeAlready) {
  Editor p("A 50 0, B 51 100, L 0 49; A 50 0, V 70 50, B 51 100, C 120 51");
  const Decision decision = p.decide('V');
  EXPECT_EQ(decision.removal, Removal::blocked);
  EXPECT_EQ(p.name(decision.blocker), "A");
  p.remove('L', Removal::loop);
  p.remove('V', Removal::regular);
  EXPECT_EQ(p.inside(), (Names{"A-C AB|AC", "C-B AB|CB"}));
}

//      A-----B            Two triangles with a shared tip W: each is removed alone, and W stays
//       \   /             as long as one of them exists.
//        \ /
//         W
//        / \              .
//       D---C
TEST(TouchingRings, AnHourglassGoesOneBulbAtATime) {
  Editor p("A 0 0, B 20 1, W 10 50; W 10 50, C 21 100, D 1 101");
  ASSERT_EQ(p.inside(), (Names{"A-B AW|AB", "B-W AW|BW", "W-C WD|WC", "C-D WD|CD"}));
  p.remove('A', Removal::loop);
  EXPECT_EQ(p.inside(), (Names{"W-C WD|WC", "C-D WD|CD"}));
  p.remove('W', Removal::loop);
  EXPECT_EQ(p.inside(), Names{});
}

//      A
//      |\  .                the last three vertices of a polygon are removed together
//      | V
//      |/
//      B
TEST(LastTriangle, APolygonIsEliminatedAsAWhole) {
  Editor p("A 0 0, V 40 50, B 1 100");
  ASSERT_EQ(p.inside(), (Names{"A-V AB|AV", "V-B AB|VB"}));
  p.remove('V', Removal::loop);
  EXPECT_EQ(p.inside(), Names{});
  EXPECT_TRUE(rings_of(p.graph).empty());
}

TEST(LastTriangle, AHoleIsFilled) {
  Editor p("A 0 0, B 100 1, C 101 101, D 1 100; V 40 40, W 60 50, X 45 70");
  p.remove('W', Removal::loop);
  EXPECT_EQ(p.inside(), (Names{"A-B AD|AB", "B-D AD|BC", "D-C DC|BC"}));
}

TEST(LastTriangle, AHoleWithAnIslandStaysUntilTheIslandHasGone) {
  Editor p(
      "A 0 0, B 300 1, C 301 301, D 1 300; V 50 50, W 250 150, X 60 250; I 90 140, J 130 150, K 95 "
      "160");
  const Decision decision = p.decide('W');
  EXPECT_EQ(decision.removal, Removal::blocked);
  const std::string blocker = p.name(decision.blocker);
  EXPECT_TRUE(blocker == "I" || blocker == "J" || blocker == "K") << blocker;
  p.remove('J', Removal::loop);
  p.remove('W', Removal::loop);
  EXPECT_EQ(p.inside().size(), 3u);
}

// The topology test proper: a lake L lies in the corner that would be cut off.
//
//      A--------C
//      |   L <> |
//      |        V           V may not go while a vertex of the lake is in the triangle C V B
//      |   .---'
//      B--'
TEST(TopologyTest, AVertexStaysWhileALakeLiesInItsTriangle) {
  Editor p("A 0 0, C 100 1, V 110 60, B 1 100; L 80 40, M 95 45, N 85 52");
  const Decision decision = p.decide('V');
  EXPECT_EQ(decision.removal, Removal::blocked);
  EXPECT_NE(std::string("LMN").find(p.name(decision.blocker)), std::string::npos);
  EXPECT_EQ(p.decide('V', 0, Topology::fast).removal, Removal::regular) << "fast does not look";
}

// A vertex exactly on the chord blocks as well: the rings would touch.
TEST(TopologyTest, AVertexOnTheNewEdgeBlocks) {
  Editor p("A 0 0, C 100 0, V 120 50, B 100 100, D 0 100; L 80 40, M 100 50, N 80 60");
  const Decision decision = p.decide('V');
  EXPECT_EQ(decision.removal, Removal::blocked);
  EXPECT_EQ(p.name(decision.blocker), "M");
}

// The lake H reaches into the triangle A V B, so V, of weight 10, must wait. When the lake is
// removed, at a weight of some 21, V is removed too, and is recorded with that tolerance.
//
//     E----------------------.
//      A                     |
//      |    .H---.           |
//      V  J'     |           |     J is the lake's tip, close to V
//      |    '---I            |
//      B                     |
//       C--------------------D
TEST(PriorityStack, ABlockedVertexGoesAsSoonAsItsBlockerHasGone) {
  Editor p("A 0 0, V -10 50, B 0 100, C 0 400, D 400 390, E 390 -10; H 60 40, I 55 62, J -5 50");
  PriorityStack stack;
  stack.assign(p.graph, {});
  EXPECT_NEAR(stack.weight(p.corner('V')), 10, 1e-9);
  EditLog log(p.graph);
  Names gone;
  std::vector<double> epsilons;
  while (const auto epsilon = stack.remove_next(p.graph, log)) {
    gone.push_back(p.name(p.graph.corner(stack.last_corner()).vertex));
    epsilons.push_back(*epsilon);
    if (gone.size() == 3) break;
  }
  EXPECT_TRUE(stack.has_blocked());
  ASSERT_EQ(gone, (Names{"B", "I", "V"}));
  EXPECT_LT(epsilons[0], 10);
  EXPECT_GT(epsilons[1], 20);
  EXPECT_EQ(epsilons[2], epsilons[1]);
}

TEST(EditLog, RevertingAndApplyingInAnyStepsIsExact) {
  for (unsigned seed = 0; seed < 70; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Rings rings = random_shape(seed);
    TrapezoidalGraph graph;
    if (!GraphBuilder().build(rings, graph).built) continue;
    EditLog log(graph);
    PriorityStack stack;
    stack.assign(graph, {});
    std::vector<TrapezoidalGraph> states{graph};
    while (states.size() < 60 && stack.remove_next(graph, log)) states.push_back(graph);
    std::mt19937 random(seed);
    for (int jump = 0; jump < 20; ++jump) {
      const std::size_t target = random() % states.size();
      while (log.applied() > target) log.revert();
      while (log.applied() < target) log.apply();
      ASSERT_EQ(graph, states[target]) << "after " << target << " edits";
      ASSERT_EQ(log.size(), states.size() - 1);
    }
  }
}

TEST(EditLog, ForgettingKeepsTheGraphAndDropsTheWayBack) {
  Editor p("V 50 0, B 80 20, C 90 70, D 10 60, A 20 20");
  EditLog log(p.graph);
  Generalization(p.graph, log).remove(p.corner('V'), Removal::extremum);
  const TrapezoidalGraph coarse = p.graph;
  EXPECT_FALSE(log.touched_nodes().empty());
  log.forget();
  EXPECT_EQ(p.graph, coarse);
  EXPECT_EQ(log.size(), 0u);
  EXPECT_EQ(log.applied(), 0u);
}

}  // namespace
}  // namespace trapeze
