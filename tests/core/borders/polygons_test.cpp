#include "core/borders/polygons.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "core/adapt/adaptable_graph.h"
#include "core/graph/check_graph.h"
#include "core/sweep/graph_builder.h"
#include "tests/core/shapes/ring_text.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TrapezoidalGraph graph_of(Rings rings) {
  TrapezoidalGraph graph;
  GraphBuilder builder;
  builder.build(rings, graph);
  return graph;
}

std::string text_of(std::span<const Point> ring) {
  std::ostringstream out;
  for (const Point p : ring) out << (out.tellp() > 0 ? ", " : "") << p.x << " " << p.y;
  return out.str();
}

/// Each polygon as text, with its rings separated by semicolons.
std::vector<std::string> texts_of(const Polygons& polygons) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    std::string text;
    for (std::size_t r = polygons.first_ring(i); r < polygons.ends[i]; ++r) {
      text += (text.empty() ? "" : "; ") + text_of(polygons.rings[r]);
    }
    texts.push_back(text);
  }
  return texts;
}

std::vector<std::string> polygons_of_text(const std::string& rings) {
  return texts_of(polygons_of(graph_of(rings_from_text(rings))));
}

TEST(Polygons, AnEmptyGraphHasNone) {
  EXPECT_TRUE(polygons_of(TrapezoidalGraph()).empty());
  EXPECT_THAT(texts_of(polygons_of(TrapezoidalGraph())), IsEmpty());
}

// y grows southwards, so counterclockwise with north up is top, west, bottom, east.
TEST(Polygons, ShellsRunCounterclockwiseAndHolesClockwiseWhateverTheSource) {
  for (const char* rings : {"0 0, 90 0, 90 90, 0 90; 20 20, 20 40, 40 40, 40 20",
                            "40 40, 20 40, 20 20, 40 20; 90 90, 90 0, 0 0, 0 90"}) {
    EXPECT_THAT(polygons_of_text(rings),
                ElementsAre("0 0, 0 90, 90 90, 90 0; 20 20, 40 20, 40 40, 20 40"));
  }
}

TEST(Polygons, SeparateRingsAreSeparatePolygonsFromTopToBottom) {
  EXPECT_THAT(polygons_of_text("0 50, 10 50, 5 60; 0 0, 10 0, 5 10; 20 0, 30 0, 25 10"),
              ElementsAre("0 0, 5 10, 10 0", "20 0, 25 10, 30 0", "0 50, 5 60, 10 50"));
}

TEST(Polygons, AnIslandInAHoleIsAPolygonOfItsOwn) {
  EXPECT_THAT(polygons_of_text("0 0, 100 0, 100 100, 0 100; 20 20, 80 20, 80 80, 20 80;"
                               "40 40, 60 40, 60 60, 40 60; 45 45, 55 45, 50 55"),
              ElementsAre("0 0, 0 100, 100 100, 100 0; 20 20, 80 20, 80 80, 20 80",
                          "40 40, 40 60, 60 60, 60 40; 45 45, 55 45, 50 55"));
}

//  *-------------*
//  |    \  /     |   The hole hangs from a vertex of the shell.
//  |     \/      |
TEST(Polygons, AHoleThatTouchesTheShellAtAVertexIsAHole) {
  EXPECT_THAT(polygons_of_text("0 0, 50 0, 100 0, 100 100, 0 100; 50 0, 60 20, 40 20"),
              ElementsAre("0 0, 0 100, 100 100, 100 0, 50 0; 50 0, 60 20, 40 20"));
}

TEST(Polygons, AHoleDrawnAsAPartOfTheShellIsAHole) {
  EXPECT_THAT(polygons_of_text("0 0, 50 0, 40 20, 60 20, 50 0, 100 0, 100 100, 0 100"),
              ElementsAre("0 0, 0 100, 100 100, 100 0, 50 0; 50 0, 60 20, 40 20"));
}

TEST(Polygons, HolesThatTouchEachOtherAtAVertexAreTwoHoles) {
  EXPECT_THAT(polygons_of_text("0 0, 100 0, 100 100, 0 100;"
                               "20 50, 35 40, 50 50, 35 60; 50 50, 65 40, 80 50, 65 60"),
              ElementsAre("0 0, 0 100, 100 100, 100 0; 35 40, 50 50, 35 60, 20 50;"
                          " 65 40, 80 50, 65 60, 50 50"));
}

//  *-----------------*
//  |        A        |
//  * <hole>*<hole>   *   A chain of holes from side to side cuts the polygon in two; the holes
//  |        B        |   become part of the shells.
//  *-----------------*
TEST(Polygons, AChainOfTouchingHolesFromSideToSideCutsThePolygonInTwo) {
  EXPECT_THAT(polygons_of_text("0 0, 100 0, 100 50, 100 100, 0 100, 0 50;"
                               "0 50, 25 40, 50 50, 25 60; 50 50, 75 40, 100 50, 75 60"),
              ElementsAre("0 0, 0 50, 25 40, 50 50, 75 40, 100 50, 100 0",
                          "0 50, 0 100, 100 100, 100 50, 75 60, 50 50, 25 60"));
}

TEST(Polygons, AClosedChainOfTouchingHolesCutsAPolygonOutOfTheMiddle) {
  // Four triangles around a square, each touching the next at a corner of it.
  EXPECT_THAT(polygons_of_text("0 0, 100 0, 100 100, 0 100; 40 40, 60 40, 50 20;"
                               "60 40, 60 60, 80 50; 60 60, 40 60, 50 80; 40 60, 40 40, 20 50"),
              ElementsAre("0 0, 0 100, 100 100, 100 0;"
                          " 50 20, 60 40, 80 50, 60 60, 50 80, 40 60, 20 50, 40 40",
                          "40 40, 40 60, 60 60, 60 40"));
}

TEST(Polygons, LobesThatMeetAtOneVertexArePolygonsOfTheirOwn) {
  EXPECT_THAT(polygons_of_text("0 0, 20 0, 10 10, 20 20, 0 20, 10 10"),
              ElementsAre("0 0, 10 10, 20 0", "10 10, 0 20, 20 20"));
}

TEST(Polygons, HolesThatHangFromOneVertexOfTheShellStayApart) {
  EXPECT_THAT(polygons_of_text("0 0, 50 0, 100 0, 100 100, 0 100;"
                               "50 0, 60 90, 55 90; 50 0, 40 90, 45 90"),
              ElementsAre("0 0, 0 100, 100 100, 100 0, 50 0;"
                          " 50 0, 45 90, 40 90; 50 0, 60 90, 55 90"));
}

/// Nothing crosses, every polygon taken alone is one connected polygon with exactly these rings,
/// and all together are the map they came from. That is validity.
void expect_valid(const Polygons& polygons, const TrapezoidalGraph& whole) {
  Rings all = polygons.rings;
  GraphBuilder builder;
  TrapezoidalGraph rebuilt;
  const BuildOutcome together = builder.build(all, rebuilt);
  EXPECT_EQ(together.built, !polygons.empty());
  if (polygons.empty()) return;
  EXPECT_FALSE(together.noded);
  EXPECT_EQ(plain_trapezoids(rebuilt), plain_trapezoids(whole));
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    Rings alone;
    for (std::size_t r = polygons.first_ring(i); r < polygons.ends[i]; ++r) {
      alone.add(polygons.rings[r]);
    }
    TrapezoidalGraph graph;
    EXPECT_FALSE(builder.build(alone, graph).noded);
    EXPECT_EQ(texts_of(polygons_of(graph)), std::vector{texts_of(polygons)[i]});
  }
}

TEST(Polygons, OfRandomShapesAreValidAtEveryTolerance) {
  for (unsigned seed = 0; seed < 350; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const TrapezoidalGraph graph = graph_of(random_shape(seed));
    if (graph.inside_nodes().empty()) continue;
    AdaptableGraph adaptable(graph);
    for (const double epsilon : {0.0, 2.0, 15.0, 300.0, 5000.0, 1e9}) {
      adaptable.adapt_to(epsilon);
      const Polygons polygons = polygons_of(adaptable.graph());
      EXPECT_FALSE(polygons.is_noded);
      EXPECT_EQ(polygons.rings.size(), rings_of(adaptable.graph()).size()) << "at " << epsilon;
      expect_valid(polygons, adaptable.graph());
    }
  }
}

TEST(Polygons, AreValidEvenWhereEdgesCrossForWantOfTheTopologyTest) {
  bool has_crossed = false;
  for (unsigned seed = 0; seed < 350; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const TrapezoidalGraph graph = graph_of(random_shape(seed));
    if (graph.inside_nodes().empty()) continue;
    AdaptableGraph adaptable(graph, {WeightRule::douglas_peucker, Topology::fast});
    for (const double epsilon : {2.0, 15.0, 300.0, 5000.0}) {
      adaptable.adapt_to(epsilon);
      const Polygons polygons = polygons_of(adaptable.graph());
      EXPECT_EQ(polygons.failure, "");
      has_crossed = has_crossed || polygons.is_noded;
      expect_valid(polygons, graph_of(polygons.rings));
    }
  }
  EXPECT_TRUE(has_crossed) << "the shapes are too tame to show it";
}

}  // namespace
}  // namespace trapeze
