// The three kinds of polygons of the paper's Figure 1, drawn from its description, and their graphs
// link by link.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/core/shapes/named_polygon.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

using Names = std::vector<std::string>;
using NameSet = std::set<std::string>;

const char* name_of(LinkKind kind) {
  switch (kind) {
    case LinkKind::connection:
      return "connection";
    case LinkKind::division:
      return "division";
    case LinkKind::join:
      return "join";
    case LinkKind::pseudo_division:
      return "pseudo-division";
    case LinkKind::pseudo_join:
      return "pseudo-join";
  }
  return "?";
}

/// A polygon whose trapezoids are numbered as in a drawing.
class Figure {
 public:
  /// `trapezoids` are named "A-B" by top and bottom vertex, T1 first.
  Figure(const std::string& polygon, const Names& trapezoids) : polygon_(polygon) {
    const std::vector<NodeId> inside = polygon_.graph.inside_nodes();
    EXPECT_EQ(inside.size(), trapezoids.size());
    for (const NodeId n : inside) {
      const auto found = std::find(trapezoids.begin(), trapezoids.end(), polygon_.name(n));
      EXPECT_NE(found, trapezoids.end()) << polygon_.name(n) << " is not in the drawing";
      number_[n] = "T" + std::to_string(found - trapezoids.begin() + 1);
    }
    NameSet numbers;
    for (const auto& [n, number] : number_) numbers.insert(number);
    EXPECT_EQ(numbers.size(), inside.size()) << "two trapezoids are drawn as one";
  }

  const TrapezoidalGraph& graph() const { return polygon_.graph; }
  const std::string& number(NodeId n) const { return number_.at(n); }

  NameSet links() const {
    NameSet found;
    for (const Link& link : graph().links()) {
      found.insert(number(link.upper) + " " + name_of(link.kind) + " " + number(link.lower));
    }
    EXPECT_EQ(found.size(), graph().links().size());
    return found;
  }

  NameSet of_connectedness(Connectedness wanted) const {
    NameSet found;
    for (const auto& [n, number] : number_) {
      if (graph().connectedness(n) == wanted) found.insert(number);
    }
    return found;
  }

  std::set<Names> chains() const {
    std::set<Names> found;
    for (const auto& chain : graph().chains()) {
      Names names;
      for (const NodeId n : chain) names.push_back(number(n));
      found.insert(names);
    }
    return found;
  }

 private:
  NamedPolygon polygon_;
  std::map<NodeId, std::string> number_;
};

double area_of(const TrapezoidalGraph& g, NodeId n) {
  const Node& node = g.node(n);
  const double top = g.point(node.end[kUp]).y;
  const double bottom = g.point(node.end[kDown]).y;
  if (top == bottom) return 0;
  const auto x = [&](Side s, double y) {
    const Point a = g.point(g.edge(node.edge[s]).end[kUp]);
    const Point b = g.point(g.edge(node.edge[s]).end[kDown]);
    return a.x + (y - a.y) * (static_cast<double>(b.x) - a.x) / (static_cast<double>(b.y) - a.y);
  };
  return (x(kRight, top) - x(kLeft, top) + x(kRight, bottom) - x(kLeft, bottom)) / 2 *
         (bottom - top);
}

/// Invariants of all chains of every graph. A chain is linked node by node by connections. It
/// begins at a suspended node, below a division or at a join, and never continues across one. Its
/// quad strip has the area of its nodes, with triangles at its ends only. Together the chains
/// contain every inside node once.
void expect_chains_and_strips(const TrapezoidalGraph& g) {
  const std::vector<Link> links = g.links();
  std::multiset<NodeId> in_chains;
  for (const auto& chain : g.chains()) {
    ASSERT_FALSE(chain.empty());
    double area = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      in_chains.insert(chain[i]);
      area += area_of(g, chain[i]);
      if (i == 0) continue;
      const Link wanted{chain[i - 1], chain[i], LinkKind::connection};
      EXPECT_TRUE(std::binary_search(links.begin(), links.end(), wanted));
    }
    for (const Link& link : links) {
      if (link.kind != LinkKind::connection) continue;
      EXPECT_NE(link.lower, chain.front()) << "a chain begins in the middle of another";
      EXPECT_NE(link.upper, chain.back()) << "a chain ends in the middle of another";
    }

    const std::vector<StripPoint> strip = quad_strip(g, chain);
    ASSERT_EQ(strip.size(), 2 * chain.size() + 2);
    double strip_area = 0;
    for (std::size_t i = 2; i < strip.size(); i += 2) {
      const double above = strip[i - 1].x - strip[i - 2].x;
      const double below = strip[i + 1].x - strip[i].x;
      strip_area += (above + below) / 2 * (strip[i].y - strip[i - 2].y);
      EXPECT_EQ(strip[i].y, strip[i + 1].y);
      EXPECT_GE(below, -1e-6);
    }
    EXPECT_NEAR(strip_area, area, 1e-9 * std::abs(area) + 1e-6);
    for (std::size_t i = 2; i + 2 < strip.size(); i += 2) {
      EXPECT_GT(strip[i + 1].x, strip[i].x) << "a triangle in the middle of a chain";
    }
  }
  const std::vector<NodeId> inside = g.inside_nodes();
  EXPECT_EQ(in_chains, std::multiset<NodeId>(inside.begin(), inside.end()));
}

//                A (20, 0)
//       B (8, 8) /T1\            .
//               /-T2-\ C (30, 16)
//   D (2, 24)  /--T3--\          .       E (70, 30)
//             |---T4---\ F (36, 40)      /T5\         .
//             |---T6----\   G (55, 50)  /----\        .
//             |          \ ,---------- /  T7  \       .
//             |-----------H (45, 60)-----------\      .
//              \         T8                     \     .
//               \--------------------------------I (80, 70)
//                \       T9                     /
//                 J (10, 85)-------------------'
//                  `-.   T10             .-'
//                     `--- K (40, 100) -'
Figure simple_polygon_with_concave_parts() {
  return Figure(
      "A 20 0, C 30 16, F 36 40, H 45 60, G 55 50, E 70 30, I 80 70, K 40 100, J 10 85, D 2 24, B "
      "8 8",
      {"A-B", "B-C", "C-D", "D-F", "E-G", "F-H", "G-H", "H-I", "I-J", "J-K"});
}

TEST(Figure1a, TwoPeaksJoinAndAllElseIsConnected) {
  EXPECT_EQ(simple_polygon_with_concave_parts().links(),
            (NameSet{"T1 connection T2", "T2 connection T3", "T3 connection T4", "T4 connection T6",
                     "T5 connection T7", "T6 join T8", "T7 join T8", "T8 connection T9",
                     "T9 connection T10"}));
}

TEST(Figure1a, TheTwoPeaksAndTheFootAreSuspended) {
  const Figure figure = simple_polygon_with_concave_parts();
  EXPECT_EQ(figure.of_connectedness(Connectedness::one_sided), (NameSet{"T1", "T5", "T10"}));
  EXPECT_EQ(figure.of_connectedness(Connectedness::two_sided),
            (NameSet{"T2", "T3", "T4", "T6", "T7", "T8", "T9"}));
}

TEST(Figure1a, StartsAtTheHigherPeakAndEndsAtTheFoot) {
  const Figure figure = simple_polygon_with_concave_parts();
  EXPECT_EQ(figure.number(figure.graph().starting_node()), "T1");
  EXPECT_EQ(figure.number(figure.graph().ending_node()), "T10");
}

TEST(Figure1a, AChainRunsDownFromEachPeakAndOneFromTheJoin) {
  const Figure figure = simple_polygon_with_concave_parts();
  EXPECT_EQ(figure.chains(),
            (std::set<Names>{{"T1", "T2", "T3", "T4", "T6"}, {"T5", "T7"}, {"T8", "T9", "T10"}}));
  expect_chains_and_strips(figure.graph());
}

//                       A (50, 0)
//                     .-' T1 '-.
//                .---B (45, 20)-----.
//             .-'   / \     T3       '-.
//          .-' T2  /   C (55, 35)-------'-.
//       .-'       /   .'      T4           '-.
//     .----------D (35, 40)-------------------'-.
//  E (0, 50)----------------- T5 ----------------'-.
//    \                        T6              ----- F (100, 55)
//     '-.---------------- T7 -----G (60, 60)----.-'
//        '-.       T8            / \    T9    .'
//           '-.                 /   H (65, 75)
//              '-.             / .'   T10  .'
//                 '-----------I (50, 80)--'
//                    '-.     T11       .'
//                       '-- K (50, 110)
Figure polygon_with_two_holes() {
  return Figure(
      "A 50 0, F 100 55, K 50 110, E 0 50; B 45 20, C 55 35, D 35 40; G 60 60, H 65 75, I 50 80",
      {"A-B", "B-D", "B-C", "C-D", "D-E", "E-F", "F-G", "G-I", "G-H", "H-I", "I-K"});
}

TEST(Figure1b, EachHoleIsADivisionAboveAndAJoinBelow) {
  EXPECT_EQ(polygon_with_two_holes().links(),
            (NameSet{"T1 division T2", "T1 division T3", "T3 connection T4", "T2 join T5",
                     "T4 join T5", "T5 connection T6", "T6 connection T7", "T7 division T8",
                     "T7 division T9", "T9 connection T10", "T8 join T11", "T10 join T11"}));
}

TEST(Figure1b, OnlyTheTopAndTheBottomAreSuspended) {
  const Figure figure = polygon_with_two_holes();
  EXPECT_EQ(figure.of_connectedness(Connectedness::one_sided), (NameSet{"T1", "T11"}));
  EXPECT_EQ(figure.of_connectedness(Connectedness::two_sided).size(), 9u);
  EXPECT_EQ(figure.number(figure.graph().starting_node()), "T1");
  EXPECT_EQ(figure.number(figure.graph().ending_node()), "T11");
}

TEST(Figure1b, ChainsRunBetweenDivisionsAndJoins) {
  const Figure figure = polygon_with_two_holes();
  EXPECT_EQ(figure.chains(),
            (std::set<Names>{
                {"T1"}, {"T2"}, {"T3", "T4"}, {"T5", "T6", "T7"}, {"T8"}, {"T9", "T10"}, {"T11"}}));
  expect_chains_and_strips(figure.graph());
}

// The shell A B C around a hole H, and an island I in the hole; the outside is not in brackets.
//
//                        A (50, 0)
//   B (10, 10)        [    T1     ]
//                    [     T2      ]       C (95, 16)
//                   [      T3       ]
//                   [ T4  H(50,25) T5 ]
//   J (22, 35)      [----'    '--     ]
//                   [ T6 |       '----]    K (80, 40)
//                   [    |  I(50,45)  |T7]
//   L (40, 58)      [    |  [T8 ]     |  ]
//                   [    | [ T9  ]    |  ] M (65, 66)
//   N (44, 72)      [    |  [ T10]    |  ]
//                   [    |  [T11]     |  ]
//                   [    |  O(52,80)  |  ]
//   D (5, 84)       [----|            |--] E (98, 86)
//   P (25, 88)      [ T12|            |T13] Q (75, 90)
//                   [ T14 '-R(50,100)-' T15]
//                    [        T16       ]
//                        F (50, 120)
Figure polygon_with_an_island() {
  return Figure(
      "A 50 0, C 95 16, E 98 86, F 50 120, D 5 84, B 10 10; H 50 25, K 80 40, Q 75 90, R 50 100, P "
      "25 88, J 22 35;"
      "I 50 45, M 65 66, O 52 80, N 44 72, L 40 58",
      {"A-B", "B-C", "C-H", "H-J", "H-K", "J-D", "K-E", "I-L", "L-M", "M-N", "N-O", "D-P", "E-Q",
       "P-R", "Q-R", "R-F"});
}

TEST(Figure1c, TheIslandHangsFromAboveItsHoleAndIsTiedBelowIt) {
  EXPECT_EQ(polygon_with_an_island().links(),
            (NameSet{"T1 connection T2", "T2 connection T3", "T3 division T4", "T3 division T5",
                     "T4 connection T6", "T6 connection T12", "T12 connection T14", "T14 join T16",
                     "T5 connection T7", "T7 connection T13", "T13 connection T15", "T15 join T16",
                     "T8 connection T9", "T9 connection T10", "T10 connection T11",
                     "T3 pseudo-division T8", "T11 pseudo-join T16"}));
}

TEST(Figure1c, PseudoLinksDoNotCountForConnectedness) {
  const Figure figure = polygon_with_an_island();
  EXPECT_EQ(figure.of_connectedness(Connectedness::one_sided), (NameSet{"T1", "T8", "T11", "T16"}));
  EXPECT_EQ(figure.number(figure.graph().starting_node()), "T1");
  EXPECT_EQ(figure.number(figure.graph().ending_node()), "T16");
}

TEST(Figure1c, TheIslandIsAChainOfItsOwn) {
  const Figure figure = polygon_with_an_island();
  EXPECT_EQ(figure.chains(), (std::set<Names>{{"T1", "T2", "T3"},
                                              {"T4", "T6", "T12", "T14"},
                                              {"T5", "T7", "T13", "T15"},
                                              {"T8", "T9", "T10", "T11"},
                                              {"T16"}}));
  expect_chains_and_strips(figure.graph());
}

TEST(Figure1c, AllNodesAreTrackedFromTheStartingNode) {
  const TrapezoidalGraph g = polygon_with_an_island().graph();
  std::set<NodeId> reached{g.starting_node()};
  for (std::size_t before = 0; before != reached.size();) {
    before = reached.size();
    for (const Link& link : g.links()) {
      if (reached.count(link.upper) != 0) reached.insert(link.lower);
      if (reached.count(link.lower) != 0) reached.insert(link.upper);
    }
  }
  EXPECT_EQ(reached.size(), g.inside_nodes().size());
}

// The hole W X Y Z contains an island with a pocket that opens downwards, and a small island in the
// pocket: the hole counts, not the pocket.
//
//      W-----------------X
//      |   E----------F  |
//      |   |  I----J  |  |
//      |   |  | S  |  |  |
//      |   |  |/ \ |  |  |
//      |   |  |U--V|  |  |
//      |   H--L    K--G  |
//      Z-----------------Y
TEST(PseudoLinks, AnIslandInThePocketOfAnotherHangsInTheHoleOfBoth) {
  const NamedPolygon p(
      "A 0 0, B 200 1, C 201 200, D 1 201; W 20 20, X 180 21, Y 181 180, Z 21 181;"
      "E 40 40, F 160 41, G 161 160, K 120 162, J 119 61, I 80 60, L 81 163, H 41 161;"
      "S 100 90, V 110 120, U 90 121");
  NameSet found;
  for (const Link& link : p.graph.pseudo_links()) {
    found.insert(p.name(link.upper) + " " + name_of(link.kind) + " " + p.name(link.lower));
  }
  EXPECT_EQ(found, (NameSet{"B-W pseudo-division E-F", "B-W pseudo-division S-V",
                            "H-L pseudo-join Z-C", "V-U pseudo-join Z-C"}));
}

// Level vertices. In the paper a horizontal side may have two vertices. Here the sweep order (y,
// then x) takes the left one first, so the side appears as a trapezoid without height between them.
// It is in the graph like any other and is never drawn.
//
//   A-------B
//   |       |     A-B (no height), B-D, D-C (no height)
//   D-------C
Figure rectangle() {
  return Figure("A 0 0, B 100 0, C 100 60, D 0 60", {"A-B", "B-D", "D-C"});
}

TEST(LevelVertices, ATwoVertexSideIsATrapezoidWithoutHeight) {
  const Figure figure = rectangle();
  EXPECT_EQ(figure.links(), (NameSet{"T1 connection T2", "T2 connection T3"}));
  for (const NodeId n : {figure.graph().starting_node(), figure.graph().ending_node()}) {
    const Node& node = figure.graph().node(n);
    EXPECT_EQ(figure.graph().point(node.end[kUp]).y, figure.graph().point(node.end[kDown]).y);
  }
}

TEST(LevelVertices, TheStripOfARectangleHasItsFourCorners) {
  const Figure figure = rectangle();
  expect_chains_and_strips(figure.graph());
  std::set<std::pair<double, double>> corners;
  for (const auto& chain : figure.graph().chains()) {
    for (const StripPoint& p : quad_strip(figure.graph(), chain)) corners.insert({p.x, p.y});
  }
  EXPECT_EQ(corners, (std::set<std::pair<double, double>>{{0, 0}, {100, 0}, {0, 60}, {100, 60}}));
}

//   A       B
//   |\     /|
//   | \   / |
//   |  \ /  |
//   |   C   |
//   |  / \  |
//   D-'   '-E
TEST(LevelVertices, OfLevelPeaksTheLeftmostStartsAndOfLevelFeetTheRightmostEnds) {
  const NamedPolygon p("A 0 0, C 50 40, B 100 0, E 90 80, F 50 60, D 10 80");
  EXPECT_EQ(p.name(p.graph.starting_node()), "A-C");
  EXPECT_EQ(p.name(p.graph.ending_node()), "F-E");
  expect_chains_and_strips(p.graph);
}

TEST(Chains, HoldOnRandomPolygonsOfAllKinds) {
  for (unsigned seed = 0; seed < 140; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Rings rings = random_shape(seed);
    TrapezoidalGraph graph;
    if (GraphBuilder().build(rings, graph).built) expect_chains_and_strips(graph);
  }
}

TEST(PseudoLinks, ThereAreTwoForEveryPartOfTheInsideThatLiesInAHole) {
  for (unsigned seed = 0; seed < 140; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Rings rings = random_shape(seed);
    TrapezoidalGraph graph;
    if (!GraphBuilder().build(rings, graph).built) continue;
    const std::vector<Link> pseudo = graph.pseudo_links();
    for (const Link& link : pseudo) {
      EXPECT_TRUE(graph.is_inside(link.upper));
      EXPECT_TRUE(graph.is_inside(link.lower));
    }
    const auto divisions = std::count_if(pseudo.begin(), pseudo.end(), [](const Link& link) {
      return link.kind == LinkKind::pseudo_division;
    });
    EXPECT_EQ(2 * static_cast<std::size_t>(divisions), pseudo.size());
  }
}

}  // namespace
}  // namespace trapeze
