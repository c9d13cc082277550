#include "core/graph/generalization.h"

#include <cassert>

namespace trapeze {

// Throughout: `back` is the direction towards the removed vertex and `d` away from it. A node on
// side s of an edge has that edge as its own edge on the opposite side.

void Generalization::remove(CornerId corner, Removal removal) {
  assert(removal != Removal::blocked && removal != Removal::region);
  log_.begin();
  switch (removal) {
    case Removal::regular:
      return remove_regular(corner);
    case Removal::extremum:
      return remove_extremum(corner);
    case Removal::loop:
      return remove_loop(corner);
    case Removal::blocked:
    case Removal::region:
      return;
  }
}

// Vertical generalization: merging on both sides of V, adjustment along both edges.
//
//        A |                     A |
//     p    |    p'                 |
//   -------V-------     =>     p   |   p'       the lines left and right of V disappear
//     q    |    q'                 |
//        B |                     B |
void Generalization::remove_regular(CornerId corner) {
  const Passage passage = passage_at(g_, corner);
  const EdgeId joined = join_edges(passage.upper_edge, passage.lower_edge);
  unlink(corner, joined);
}

/// Joins two successive edges, with the nodes along them, and returns the edge that remains. The
/// edge with fewer nodes along it is removed.
EdgeId Generalization::join_edges(EdgeId upper, EdgeId lower) {
  const bool keep_lower = upper_list_is_shorter(upper, lower);
  const EdgeId keep = keep_lower ? lower : upper;
  const EdgeId gone = keep_lower ? upper : lower;
  const Edge above = g_.edge(upper);
  const Edge below = g_.edge(lower);
  for (const Side s : {kLeft, kRight}) {
    const Side own = opposite(s);
    for (NodeId n = g_.edge(gone).extreme[s][kUp]; !n.is_none(); n = g_.node(n).link[own][kDown]) {
      log_.edit(n).edge[own] = keep;
    }
  }
  Edge& kept = log_.edit(keep);
  kept.end[kUp] = above.end[kUp];
  kept.end[kDown] = below.end[kDown];
  for (const Side s : {kLeft, kRight}) {
    kept.extreme[s][kUp] = above.extreme[s][kUp];
    kept.extreme[s][kDown] = below.extreme[s][kDown];
  }
  kill(gone);
  for (const Side s : {kLeft, kRight}) {
    const Side own = opposite(s);
    const NodeId p = above.extreme[s][kDown];
    const NodeId q = below.extreme[s][kUp];
    const bool line_disappears = g_.node(p).link[s][kDown] == q;
    set_link(p, own, kDown, q);
    set_link(q, own, kUp, p);
    if (line_disappears) merge_stacked(p, q, kDown);
  }
  return keep;
}

bool Generalization::upper_list_is_shorter(EdgeId upper, EdgeId lower) const {
  // Both lists in parallel, so that the cost is that of the shorter one.
  NodeId up[2];
  NodeId down[2];
  for (const Side s : {kLeft, kRight}) {
    up[s] = g_.edge(upper).extreme[s][kUp];
    down[s] = g_.edge(lower).extreme[s][kUp];
  }
  const auto advance = [this](NodeId(&list)[2]) {
    bool more = false;
    for (const Side s : {kLeft, kRight}) {
      if (!list[s].is_none()) list[s] = g_.node(list[s]).link[opposite(s)][kDown];
      more = more || !list[s].is_none();
    }
    return more;
  };
  for (;;) {
    if (!advance(down)) return false;
    if (!advance(up)) return true;
  }
}

// The horizontal line between two nodes with the same edges disappears:
//
//   |   keep   |             |          |
//   |----------|      =>     |   keep   |       (d: downwards)
//   |   gone   |             |          |
void Generalization::merge_stacked(NodeId keep, NodeId gone, Direction d) {
  const Node lost = g_.node(gone);
  Node& merged = log_.edit(keep);
  merged.end[d] = lost.end[d];
  for (const Side s : {kLeft, kRight}) merged.link[s][d] = lost.link[s][d];
  for (const Side s : {kLeft, kRight}) {
    const NodeId next = lost.link[s][d];
    if (next.is_none()) {
      extreme_of(lost.edge[s], opposite(s), d) = keep;
    } else {
      set_link(next, s, opposite(d), keep);
    }
  }
  kill(gone);
}

// Horizontal generalization. The tip (wedge) is eliminated. The nodes on its two outer sides merge
// pairwise from top to bottom, down to A, the nearer neighbour. The far edge now starts at A, and a
// division or join at V becomes one at A.
//
//   |      u      |              |             |
//   |------V------|              |             |
//   | p1  / \ q1  |              |      u      |
//   |----/   \    |      =>      |-------------|
//   | p2/wedge\---|              |     p2      |
//   | A ------ \q2|              |----A--------|
//      \   x    \ |                  / \   q2  |
//       C     far B                 C x  \ far B
void Generalization::remove_extremum(CornerId corner) {
  const Extremum x = extremum_at(g_, corner);
  const Direction d = x.away;
  const Direction back = opposite(d);
  const Edge far = g_.edge(x.far_edge);
  const Side s = g_.node(far.extreme[kLeft][back]).edge[kLeft] == x.near_edge ? kLeft : kRight;
  const Side other = opposite(s);
  const NodeId wedge = far.extreme[s][back];
  const NodeId below_wedge = g_.node(wedge).link[other][d];
  const NodeId p = g_.edge(x.near_edge).extreme[s][back];
  const NodeId q = far.extreme[other][back];
  const NodeId beyond = g_.node(p).link[s][back];
  const bool line_disappears = !beyond.is_none() && g_.node(q).link[other][back] == beyond;

  const Zipped zipped = zip(p, q, s, d, x.near_vertex);
  Edge& shortened = log_.edit(x.far_edge);
  shortened.end[back] = x.near_vertex;
  shortened.extreme[other][back] = zipped.rest;
  shortened.extreme[s][back] = below_wedge;
  set_link(zipped.rest, s, back, NodeId());
  set_link(below_wedge, other, back, NodeId());
  kill(wedge);
  kill(x.near_edge);
  if (line_disappears) merge_stacked(beyond, zipped.first, d);
  unlink(corner, x.far_edge);
}

// A triangle disappears: first its middle vertex, then the two remaining edges.
//
//        T                T
//       / \              / \                  |  one node a  |
//    p1/   \   =>      p/   \ q      =>       |  line from   |
//     M     \  q       (     )                |  both sides  |
//    p2\     \          \   /                 |              |
//          `--B           B
void Generalization::remove_loop(CornerId corner) {
  const TriangleLoop loop = triangle_loop_at(g_, corner);
  const VertexId bottom = g_.corner(loop.bottom).vertex;
  const Side s = loop.side;
  const Side other = opposite(s);
  const EdgeId joined = join_edges(loop.upper_edge, loop.lower_edge);
  const NodeId inside = g_.edge(loop.long_edge).extreme[s][kUp];
  const NodeId p = g_.edge(joined).extreme[s][kUp];
  const NodeId q = g_.edge(loop.long_edge).extreme[other][kUp];
  const NodeId above = g_.node(p).link[s][kUp];
  const bool top_disappears = !above.is_none() && g_.node(q).link[other][kUp] == above;

  const Zipped zipped = zip(p, q, s, kDown, bottom);
  kill(inside);
  kill(joined);
  kill(loop.long_edge);
  const Node& last = g_.node(zipped.last);
  const NodeId below = last.link[s][kDown];
  if (!below.is_none() && last.link[other][kDown] == below)
    merge_stacked(zipped.last, below, kDown);
  if (top_disappears) merge_stacked(above, zipped.first, kDown);
  for (const CornerId c : {loop.top, loop.middle, loop.bottom}) {
    log_.edit(c) = Corner{g_.corner(c).vertex, {}, {}, {}};
  }
}

// The border between two faces that become one disappears.
//
//     T                    T
//  p1 | q1              |  p1  |       the lines through T and B disappear too, unless another
//  ---|           =>    |------|       edge begins or ends there
//  p2 |---              |  q1  |
//     | q2              |------|
//     B                    B
void Generalization::remove_edge(EdgeId edge) {
  const Edge gone = g_.edge(edge);
  const NodeId p = gone.extreme[kLeft][kUp];
  const NodeId q = gone.extreme[kRight][kUp];
  const NodeId above = g_.node(p).link[kLeft][kUp];
  const bool top_disappears = !above.is_none() && g_.node(q).link[kRight][kUp] == above;

  const Zipped zipped = zip(p, q, kLeft, kDown, gone.end[kDown]);
  kill(edge);
  const Node& last = g_.node(zipped.last);
  const NodeId below = last.link[kLeft][kDown];
  if (!below.is_none() && last.link[kRight][kDown] == below) {
    merge_stacked(zipped.last, below, kDown);
  }
  if (top_disappears) merge_stacked(above, zipped.first, kDown);
}

// Two lists of nodes along the outer sides of two edges become one when the edges disappear between
// them. The node that ends first is widened to the far side of the other list, and the other node
// continues below it, until `stop` is reached.
//
//   |near|  |far |            |  near   |
//   |----|  |    |     =>     |---------|
//   |    |  |----|            |  far    |
//                             |---------|
Generalization::Zipped Generalization::zip(NodeId near, NodeId far, Side near_side, Direction d,
                                           VertexId stop) {
  const Side far_side = opposite(near_side);
  const Direction back = opposite(d);
  Zipped zipped;
  for (;;) {
    const VertexId near_end = g_.node(near).end[d];
    const VertexId far_end = g_.node(far).end[d];
    const bool near_first = near_end == far_end || (near_end < far_end) == (d == kDown);
    const NodeId ending = near_first ? near : far;
    if (zipped.first.is_none()) zipped.first = ending;
    if (near_end == far_end) {
      assert(near_end == stop);
      drop_beside(near, far, far_side, d);
      zipped.last = near;
      return zipped;
    }
    const NodeId next = g_.node(ending).link[near_first ? far_side : near_side][d];
    if (near_first) {
      insert_before(near, far, far_side, d);
      log_.edit(far).end[back] = near_end;
      if (near_end == stop) {
        zipped.last = near;
        zipped.rest = far;
        return zipped;
      }
      near = next;
    } else {
      insert_before(far, near, near_side, d);
      log_.edit(near).end[back] = far_end;
      far = next;
    }
  }
}

/// Inserts `n` before `next` in the list of nodes along the edge that `next` has on `side`.
void Generalization::insert_before(NodeId n, NodeId next, Side side, Direction d) {
  const Direction back = opposite(d);
  const EdgeId e = g_.node(next).edge[side];
  const NodeId before = g_.node(next).link[side][back];
  Node& inserted = log_.edit(n);
  inserted.edge[side] = e;
  inserted.link[side][back] = before;
  inserted.link[side][d] = next;
  set_link(next, side, back, n);
  if (before.is_none()) {
    extreme_of(e, opposite(side), back) = n;
  } else {
    set_link(before, side, d, n);
  }
}

/// Merges `gone` into `keep`, which has the same top and bottom. `keep` gets the edge and the links
/// of `gone` on `side`.
void Generalization::drop_beside(NodeId keep, NodeId gone, Side side, Direction d) {
  const Node lost = g_.node(gone);
  Node& widened = log_.edit(keep);
  widened.edge[side] = lost.edge[side];
  for (const Direction to : {d, opposite(d)}) widened.link[side][to] = lost.link[side][to];
  for (const Direction to : {d, opposite(d)}) {
    if (lost.link[side][to].is_none()) {
      extreme_of(lost.edge[side], opposite(side), to) = keep;
    } else {
      set_link(lost.link[side][to], side, opposite(to), keep);
    }
  }
  kill(gone);
}

/// Removes the corner from its loop; the edge between its neighbours is `joined`.
void Generalization::unlink(CornerId corner, EdgeId joined) {
  const Corner removed = g_.corner(corner);
  log_.edit(removed.prev).next = removed.next;
  log_.edit(removed.prev).edge = joined;
  log_.edit(removed.next).prev = removed.prev;
  log_.edit(corner) = Corner{removed.vertex, {}, {}, {}};
}

}  // namespace trapeze
