#include "core/sweep/trapezoidation.h"

#include <algorithm>

namespace trapeze {
namespace {

/// Negative if p lies left of the edge (on the sweep line through p), positive if right, 0 if on
/// it.
std::int64_t side_of(Point upper, Point lower, Point p) {
  return -orientation(upper, lower, p);
}

}  // namespace

bool Trapezoidation::build(const Boundary& boundary, TrapezoidalGraph& graph) {
  boundary_ = &boundary;
  face_beyond_ = nullptr;
  graph_ = &graph;
  return sweep();
}

bool Trapezoidation::build(const Boundary& boundary, const FaceBeyond& face_beyond,
                           TrapezoidalGraph& graph) {
  boundary_ = &boundary;
  face_beyond_ = &face_beyond;
  graph_ = &graph;
  return sweep();
}

bool Trapezoidation::sweep() {
  start();
  const std::size_t count = boundary_->vertices.size() - 2;
  for (std::size_t v = 1; v <= count; ++v) {
    if (!sweep_vertex(VertexId(v))) return false;
  }
  // Only the frame remains; its last node ends at infinity.
  close(Status::kFirst, VertexId(count + 1));
  return true;
}

void Trapezoidation::start() {
  const std::size_t count = boundary_->edges.size();
  TrapezoidalGraph& g = *graph_;
  g.vertices_ = boundary_->vertices;
  g.face_count_ = 1;
  g.corners_.clear();
  g.nodes_.clear();
  g.nodes_.reserve(2 * count + 2);
  g.edges_.resize(count + 2);
  for (std::size_t e = 0; e < count; ++e) {
    const Boundary::Ends ends = boundary_->edges[EdgeId(e)];
    g.edges_[EdgeId(e)] = Edge{{ends.upper, ends.lower}, {}, {kOutside, kOutside}};
  }
  const VertexId last(boundary_->vertices.size() - 1);
  for (const Side side : {kLeft, kRight}) {
    g.frame_[side] = EdgeId(count + static_cast<std::size_t>(side));
    g.edges_[g.frame_[side]] = Edge{{VertexId(0), last}, {}, {kOutside, kOutside}};
  }
  slot_of_.resize(count + 2);
  status_.clear();
  status_[Status::kFirst].edge = g.frame_[kLeft];
  status_[Status::kLast].edge = g.frame_[kRight];
  open(Status::kFirst, VertexId(0));
}

bool Trapezoidation::sweep_vertex(VertexId v) {
  const auto edges = boundary_->edges_at(v);
  if (edges.size() == 2) {
    const bool first_ends = boundary_->edges[edges[0]].lower == v;
    const bool second_ends = boundary_->edges[edges[1]].lower == v;
    if (first_ends != second_ends) {
      return sweep_regular(v, edges[first_ends ? 0 : 1], edges[first_ends ? 1 : 0]);
    }
  }
  return sweep_general(v);
}

// The boundary passes through v from above to below:
//
//       |  ending
//   ----v----          two nodes close and two open; the slot stays where it is.
//       |  starting
bool Trapezoidation::sweep_regular(VertexId v, EdgeId ending, EdgeId starting) {
  TrapezoidalGraph& g = *graph_;
  const Slot slot = slot_of_[ending.value];
  const Slot left = status_.prev(slot);
  const Slot right = status_.next(slot);
  const NodeId upper_left = close(left, v);
  const NodeId upper_right = close(slot, v);
  status_[slot].edge = starting;
  slot_of_[starting.value] = slot;
  Edge& edge = g.edges_[starting];
  edge.face[kLeft] = g.edges_[ending].face[kLeft];
  edge.face[kRight] = g.edges_[ending].face[kRight];
  link(kLeft, upper_left, open(left, v));
  link(kRight, upper_right, open(slot, v));
  return is_apart(left, slot) && is_apart(slot, right);
}

// Any number of edges end and start at v:
//
//     \   |   /   ending_
//   ---------v---------
//       /    \    starting_
bool Trapezoidation::sweep_general(VertexId v) {
  ending_.clear();
  starting_.clear();
  for (const EdgeId e : boundary_->edges_at(v)) {
    (boundary_->edges[e].lower == v ? ending_ : starting_).push_back(e);
  }
  if (!sort_starting_edges(v)) return false;

  Slot left;
  if (ending_.empty()) {
    left = locate(v);
    if (left == Status::kNoSlot) return false;
  } else {
    const Slot first = first_of_run(v, ending_.size());
    if (first == Status::kNoSlot) return false;
    left = status_.prev(first);
  }
  TrapezoidalGraph& g = *graph_;
  const NodeId upper_left = close(left, v);
  NodeId upper_right = upper_left;
  for (std::size_t i = 0; i < ending_.size(); ++i) {
    const Slot slot = status_.next(left);
    upper_right = close(slot, v);
    status_.remove(slot);
  }
  const Slot right = status_.next(left);

  // Unless the caller gives faces, they alternate from left to right (even-odd).
  Slot last = left;
  FaceId face = g.edges_[status_[left].edge].face[kRight];
  for (const EdgeId e : starting_) {
    last = status_.insert_after(last, {e, {}});
    slot_of_[e.value] = last;
    g.edges_[e].face[kLeft] = face;
    face = face_beyond_ != nullptr ? (*face_beyond_)(e, face) : (face == kOutside ? 1 : kOutside);
    g.edges_[e].face[kRight] = face;
  }
  link(kLeft, upper_left, open(left, v));
  for (Slot slot = status_.next(left); slot != right; slot = status_.next(slot)) open(slot, v);
  link(kRight, upper_right, status_[last].right);

  if (last == left) return is_apart(left, right);
  return is_apart(left, status_.next(left)) && is_apart(last, right);
}

bool Trapezoidation::sort_starting_edges(VertexId v) {
  const Point p = boundary_->vertices[v];
  const auto lower = [this](EdgeId e) { return boundary_->vertices[boundary_->edges[e].lower]; };
  std::sort(starting_.begin(), starting_.end(),
            [&](EdgeId a, EdgeId b) { return side_of(p, lower(a), lower(b)) > 0; });
  for (std::size_t i = 1; i < starting_.size(); ++i) {
    if (side_of(p, lower(starting_[i - 1]), lower(starting_[i])) == 0) return false;
  }
  return true;
}

Trapezoidation::Slot Trapezoidation::first_of_run(VertexId v, std::size_t count) const {
  const auto ends_at_v = [&](Slot slot) {
    return slot > Status::kLast && boundary_->edges[status_[slot].edge].lower == v;
  };
  Slot first = slot_of_[ending_.front().value];
  while (ends_at_v(status_.prev(first))) first = status_.prev(first);
  Slot slot = first;
  for (std::size_t i = 1; i < count; ++i) {
    slot = status_.next(slot);
    if (!ends_at_v(slot)) return Status::kNoSlot;
  }
  return first;
}

NodeId Trapezoidation::close(Slot slot, VertexId v) {
  const NodeId n = status_[slot].right;
  Node& node = graph_->nodes_[n];
  node.end[kDown] = v;
  graph_->edges_[node.edge[kLeft]].extreme[kRight][kDown] = n;
  graph_->edges_[node.edge[kRight]].extreme[kLeft][kDown] = n;
  return n;
}

NodeId Trapezoidation::open(Slot slot, VertexId v) {
  TrapezoidalGraph& g = *graph_;
  Node node;
  node.end[kUp] = v;
  node.edge[kLeft] = status_[slot].edge;
  node.edge[kRight] = status_[status_.next(slot)].edge;
  const NodeId n = g.nodes_.push_back(node);
  Edge& left = g.edges_[node.edge[kLeft]];
  Edge& right = g.edges_[node.edge[kRight]];
  if (left.end[kUp] == v) left.extreme[kRight][kUp] = n;
  if (right.end[kUp] == v) right.extreme[kLeft][kUp] = n;
  status_[slot].right = n;
  return n;
}

void Trapezoidation::link(Side side, NodeId upper, NodeId lower) {
  graph_->nodes_[upper].link[side][kDown] = lower;
  graph_->nodes_[lower].link[side][kUp] = upper;
}

Trapezoidation::Slot Trapezoidation::locate(VertexId v) const {
  const Point p = boundary_->vertices[v];
  const Status::Location found = status_.locate([&](const Crossing& crossing) {
    const Boundary::Ends e = boundary_->edges[crossing.edge];
    return side_of(boundary_->vertices[e.upper], boundary_->vertices[e.lower], p);
  });
  return found.on == Status::kNoSlot ? found.left : Status::kNoSlot;
}

bool Trapezoidation::is_apart(Slot left, Slot right) const {
  if (left == Status::kFirst || right == Status::kLast) return true;
  const Boundary::Ends a = boundary_->edges[status_[left].edge];
  const Boundary::Ends b = boundary_->edges[status_[right].edge];
  if (a.lower == b.lower) return true;
  const auto& at = boundary_->vertices;
  return a.lower < b.lower ? side_of(at[b.upper], at[b.lower], at[a.lower]) < 0
                           : side_of(at[a.upper], at[a.lower], at[b.lower]) > 0;
}

}  // namespace trapeze
