// A polygon whose vertices have names of one letter, and its graph, so that tests can refer to both
// by geometry. A trapezoid is "A-B" by its top and bottom vertex, or in full "A-B AC|DB" with its
// left and right edge, each from its upper to its lower end.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/graph/check_graph.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/sweep/graph_builder.h"

namespace trapeze {

class NamedPolygon {
 public:
  /// Vertices as "name x y" separated by commas, rings by semicolons. Rings do not cross, and have
  /// no vertex on an edge. A vertex where rings touch is defined once and then referred to by its
  /// name.
  explicit NamedPolygon(const std::string& text) {
    Rings rings;
    std::istringstream rings_in(text);
    for (std::string ring; std::getline(rings_in, ring, ';');) {
      std::istringstream vertices_in(ring);
      for (std::string vertex; std::getline(vertices_in, vertex, ',');) {
        std::istringstream in(vertex);
        char name = 0;
        Point p;
        in >> name >> p.x >> p.y;
        EXPECT_FALSE(in.fail()) << "not a vertex: " << vertex;
        names_.emplace_back(name, p);
        rings.points.push_back(p);
      }
      rings.close_ring();
    }
    const BuildOutcome outcome = GraphBuilder().build(rings, graph);
    EXPECT_TRUE(outcome.built);
    EXPECT_FALSE(outcome.noded);
    EXPECT_EQ(check_graph(graph), "");
  }

  TrapezoidalGraph graph;

  Point point(char name) const {
    const auto found =
        std::find_if(names_.begin(), names_.end(), [&](const auto& n) { return n.first == name; });
    EXPECT_NE(found, names_.end()) << name;
    return found->second;
  }

  std::string name(VertexId v) const {
    const Point p = graph.point(v);
    const auto found =
        std::find_if(names_.begin(), names_.end(), [&](const auto& n) { return n.second == p; });
    return found == names_.end() ? "?" : std::string(1, found->first);
  }

  /// The corner of that vertex, in the loop that also passes through `other` if one is named.
  CornerId corner(char vertex, char other = 0) const {
    for (std::size_t i = 0; i < graph.corners().size(); ++i) {
      const CornerId c(i);
      if (!graph.corner(c).is_alive() || graph.point(graph.corner(c).vertex) != point(vertex))
        continue;
      if (other == 0 || loop_has(c, point(other))) return c;
    }
    ADD_FAILURE() << "no corner at " << vertex;
    return CornerId();
  }

  std::string name(NodeId n) const {
    const Node& node = graph.node(n);
    return name(node.end[kUp]) + "-" + name(node.end[kDown]);
  }

  std::string full_name(NodeId n) const {
    const auto edge = [&](Side s) {
      const Edge& e = graph.edge(graph.node(n).edge[s]);
      return name(e.end[kUp]) + name(e.end[kDown]);
    };
    return name(n) + " " + edge(kLeft) + "|" + edge(kRight);
  }

  /// The full names of all inside trapezoids, from top to bottom and from left to right.
  std::vector<std::string> inside() const {
    std::vector<NodeId> nodes = graph.inside_nodes();
    std::sort(nodes.begin(), nodes.end(), [this](NodeId a, NodeId b) {
      const VertexId top_a = graph.node(a).end[kUp];
      const VertexId top_b = graph.node(b).end[kUp];
      if (top_a != top_b) return top_a < top_b;
      // If two trapezoids begin at one vertex, the right edge of the left one begins there as well.
      return graph.edge(graph.node(a).edge[kRight]).end[kUp] == top_a &&
             graph.edge(graph.node(b).edge[kRight]).end[kUp] != top_b;
    });
    std::vector<std::string> found;
    for (const NodeId n : nodes) found.push_back(full_name(n));
    return found;
  }

 private:
  bool loop_has(CornerId first, Point p) const {
    CornerId c = first;
    do {
      if (graph.point(graph.corner(c).vertex) == p) return true;
      c = graph.corner(c).next;
    } while (c != first);
    return false;
  }

  std::vector<std::pair<char, Point>> names_;
};

}  // namespace trapeze
