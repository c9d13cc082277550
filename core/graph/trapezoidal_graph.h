// The trapezoidal graph of one polygon (paper, section 3.1): trapezoids are nodes, and the
// relations between a trapezoid and the ones above and below it are links.
//
// The graph meshes the whole plane, inside and outside, within a frame of two edges and two
// vertices at infinity. Corners of trapezoids are implied by edges and never stored, so no vertices
// are introduced. Vertices are numbered in sweep order (y, then x): "above" is a comparison of ids.
//
//            top vertex (at a corner or between)
//        ----*----------
//       /               \        Each node knows the next node along its left edge and along its
//  left/     node        \right  right edge, upwards and downwards. These lists are the links: two
//     /                   \      different nodes below are a division, one that also has another
//    ------------*---------      node above it is a join, anything else is a connection.
//            bottom vertex
//
// Several rings may touch at a vertex; no two edges cross or overlap, no vertex lies on an edge.
// The numbered invariants are in core/README.md; check_graph() verifies them.
//
// Thread-safety: none; different graphs may be used by different threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/ids.h"
#include "core/grid/rings.h"

namespace trapeze {

enum Side : int { kLeft = 0, kRight = 1 };
enum Direction : int { kUp = 0, kDown = 1 };

constexpr Side opposite(Side s) {
  return static_cast<Side>(1 - s);
}
constexpr Direction opposite(Direction d) {
  return static_cast<Direction>(1 - d);
}

/// A trapezoid. `end` holds its top and bottom vertex, `edge` its left and right edge, and
/// `link[side][direction]` the next node along that edge (none at the end of the edge).
struct Node {
  VertexId end[2];
  EdgeId edge[2];
  NodeId link[2][2];

  bool is_alive() const { return !end[kUp].is_none(); }
  friend bool operator==(const Node&, const Node&) = default;
};

/// A straight piece of the boundary or of the frame. `end` holds its upper and lower vertex,
/// `extreme[side][direction]` the topmost and bottommost node on its left and right, `face` the
/// face on its left and right.
struct Edge {
  VertexId end[2];
  NodeId extreme[2][2];
  FaceId face[2] = {kOutside, kOutside};

  bool is_alive() const { return !end[kUp].is_none(); }
  friend bool operator==(const Edge&, const Edge&) = default;
};

/// One visit of a simple loop of the boundary to a vertex, and the edge by which the loop leaves
/// it.
///
/// In a coverage, the boundary also consists of arcs, which lead from one junction to another or
/// back to the same one. The first corner of an arc has no previous corner; the last one has no
/// next corner and no edge.
struct Corner {
  VertexId vertex;
  EdgeId edge;
  CornerId prev;
  CornerId next;

  bool is_alive() const { return !prev.is_none() || !next.is_none(); }
  /// Whether an arc begins or ends here, at a junction.
  bool is_end() const { return prev.is_none() != next.is_none(); }
  friend bool operator==(const Corner&, const Corner&) = default;
};

enum class LinkKind : std::uint8_t { connection, division, join, pseudo_division, pseudo_join };

/// A link of the paper's graph between an upper and a lower inside node.
struct Link {
  NodeId upper;
  NodeId lower;
  LinkKind kind = LinkKind::connection;

  friend auto operator<=>(const Link&, const Link&) = default;
};

/// How many nodes of its own face a node is linked to, by side (paper, sections 3.1 and 3.2).
enum class Connectedness : std::uint8_t {
  isolated,   // none above and none below: a polygon of a single trapezoid
  one_sided,  // suspended: above or below only
  two_sided,
};

class TrapezoidalGraph {
 public:
  /// Vertices of the boundary are numbered 1 .. vertex_count(). Vertex 0 and vertex_count() + 1
  /// belong to the frame, at y = minus and plus infinity; their points have no meaning.
  std::size_t vertex_count() const { return vertices_.size() < 2 ? 0 : vertices_.size() - 2; }
  Point point(VertexId v) const { return vertices_[v]; }
  bool is_frame(VertexId v) const { return v.value == 0 || v.value + 1 == vertices_.size(); }
  bool is_frame(EdgeId e) const { return e == frame_[kLeft] || e == frame_[kRight]; }

  const Table<VertexId, Point>& vertices() const { return vertices_; }
  const Table<EdgeId, Edge>& edges() const { return edges_; }
  const Table<NodeId, Node>& nodes() const { return nodes_; }
  const Table<CornerId, Corner>& corners() const { return corners_; }
  const Edge& edge(EdgeId e) const { return edges_[e]; }
  const Node& node(NodeId n) const { return nodes_[n]; }
  const Corner& corner(CornerId c) const { return corners_[c]; }
  /// Faces are numbered 1 .. face_count(); the outside is kOutside.
  FaceId face_count() const { return face_count_; }
  /// Whether this is the graph of several polygons that share borders.
  bool is_coverage() const { return face_count_ > 1; }
  EdgeId frame_edge(Side s) const { return frame_[s]; }

  FaceId face(const Node& n) const { return edges_[n.edge[kLeft]].face[kRight]; }
  bool is_inside(NodeId n) const { return face(nodes_[n]) != kOutside; }
  /// Alive nodes inside, in order of id.
  std::vector<NodeId> inside_nodes() const;

  /// The 0, 1 or 2 nodes next to `n` in that direction, from left to right.
  struct Neighbours {
    std::array<NodeId, 2> node;
    int count = 0;
  };
  Neighbours neighbours(NodeId n, Direction d) const;

  /// The paper's links between inside nodes, in order of upper and lower node: connections,
  /// divisions and joins, plus pseudo-divisions and pseudo-joins for islands.
  std::vector<Link> links() const;
  /// The links that tie an island to its surroundings. The island's starting node hangs by a
  /// pseudo-division on the node above the hole it lies in; its ending node is tied by a
  /// pseudo-join to the node below that hole. Derived from the outside trapezoids of the hole.
  std::vector<Link> pseudo_links() const;
  Connectedness connectedness(NodeId n) const;

  /// The paper's starting node is the topmost inside node, or the leftmost of several with the same
  /// top y. The ending node is the bottommost, or the rightmost of several with the same bottom y.
  /// None if there are no inside nodes.
  NodeId starting_node() const;
  NodeId ending_node() const;

  /// Maximal runs of inside nodes, each linked to the next by a connection. Together they contain
  /// every inside node exactly once.
  std::vector<std::vector<NodeId>> chains() const;

  /// Twice the exact area of all inside nodes, in cells squared, summed edge by edge over the nodes
  /// along them. Equal to the area of the rings if and only if the nodes tile every edge.
  Int128 doubled_area() const;
  /// The same, by face.
  std::vector<Int128> doubled_areas() const;

  /// Bytes of memory held.
  std::size_t memory() const;

  friend bool operator==(const TrapezoidalGraph&, const TrapezoidalGraph&) = default;

 private:
  friend class Trapezoidation;  // builds it
  friend class EditLog;         // changes it, by edit records only
  friend class BoundaryLoops;   // pairs corners along loops
  friend class BorderArcs;      // pairs corners of several polygons and assigns their faces

  Table<VertexId, Point> vertices_;
  Table<EdgeId, Edge> edges_;
  Table<NodeId, Node> nodes_;
  Table<CornerId, Corner> corners_;
  EdgeId frame_[2];
  FaceId face_count_ = 1;
};

/// A point of a quad strip, in cells: a point of an edge at the y of a vertex. x is rounded to a
/// double.
struct StripPoint {
  double x = 0;
  double y = 0;
};

/// Twice the area that an edge adds to the face on its left and subtracts from the face on its
/// right, in cells squared. The sum over all edges of a face is exact.
Int128 doubled_strip(const TrapezoidalGraph& graph, const Edge& edge);

/// The loops of the boundary of the present graph, read from its corners.
Rings rings_of(const TrapezoidalGraph& graph);

/// A trapezoidal chain as a quad strip: the left and right point of the top of the first node, then
/// the left and right point of the bottom of every node.
std::vector<StripPoint> quad_strip(const TrapezoidalGraph& graph, const std::vector<NodeId>& chain);

}  // namespace trapeze
