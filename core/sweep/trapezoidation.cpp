#include "core/sweep/trapezoidation.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <unordered_map>

#include "core/grid/for_each_in_parallel.h"
#include "core/sweep/sweep_order.h"
#include "core/sweep/sweep_slabs.h"

namespace trapeze {
namespace {

/// Sorts edges that start at v from left to right; false if two of them coincide there.
bool sort_around(const Boundary& boundary, VertexId v, std::vector<EdgeId>& starting) {
  if (starting.size() < 2) return true;
  const Point p = boundary.vertices[v];
  const auto lower = [&boundary](EdgeId e) { return boundary.vertices[boundary.edges[e].lower]; };
  std::sort(starting.begin(), starting.end(),
            [&](EdgeId a, EdgeId b) { return side_of(p, lower(a), lower(b)) > 0; });
  for (std::size_t i = 1; i < starting.size(); ++i) {
    if (side_of(p, lower(starting[i - 1]), lower(starting[i])) == 0) return false;
  }
  return true;
}

}  // namespace

/// The sweep over the vertices [first, last), independent of the rest. Nodes open at the first
/// vertex were opened in an earlier slab: placeholders for them are numbered from `first_guest` on,
/// from left to right.
class Trapezoidation::Slab {
 public:
  explicit Slab(Trapezoidation& owner) : owner_(owner) {}

  void begin(VertexId first, VertexId last);
  void begin(VertexId first, VertexId last, std::vector<EdgeId> across, NodeId first_guest);
  /// False if the boundary is not noded, or if `is_failed` has become true.
  bool run(std::atomic<bool>& is_failed);

  /// The edges that cross the sweep line at its beginning.
  const std::vector<EdgeId>& across() const { return across_; }
  NodeId guest(std::size_t i) const { return NodeId(first_guest_.value + i); }
  std::size_t guests() const { return guests_; }

  /// Calls visit(edge, node) for the left side of the frame and for each edge that crosses the
  /// sweep line, with the open node on its right.
  template <typename Visit>
  void for_each_open(const Visit& visit) const {
    for (Slot slot = Status::kFirst; slot != Status::kLast; slot = status_.next(slot)) {
      visit(status_[slot].edge, status_[slot].right);
    }
  }

 private:
  // An edge that crosses the sweep line, and the open node to its right.
  struct Crossing {
    EdgeId edge;
    NodeId right;  // between this edge and the next
  };
  using Status = SweepOrder<Crossing>;
  using Slot = Status::Slot;

  bool sweep_vertex(VertexId v);
  bool sweep_regular(VertexId v, EdgeId ending, EdgeId starting);
  bool sweep_general(VertexId v);
  /// The first of the slots whose edges end at v, which must be neighbours; none if they are not.
  Slot first_of_run(VertexId v, std::size_t count) const;

  /// Closes the node right of `slot` at v and returns it.
  NodeId close(Slot slot, VertexId v);
  /// Opens a node right of `slot` at v.
  NodeId open(Slot slot, VertexId v);
  void open_as(Slot slot, NodeId n, VertexId v);
  void link(Side side, NodeId upper, NodeId lower);

  Slot slot_of(EdgeId e) const {
    return owner_.boundary_->edges[e].upper < first_ ? slot_across_.at(e.value)
                                                     : owner_.slot_of_[e.value];
  }
  /// The slot of the edge directly left of v; none if v lies on an edge.
  Slot locate(VertexId v) const;
  /// Whether the neighbours `left` and `right` do not meet below the sweep line, except at a common
  /// end.
  bool is_apart(Slot left, Slot right) const;

  Trapezoidation& owner_;
  VertexId first_;
  VertexId last_;
  std::vector<EdgeId> across_;
  NodeId first_guest_;
  std::size_t guests_ = 0;
  bool may_run_ = true;
  NodeId next_node_;                                     // the number of the next node to be opened
  Status status_;                                        // its ends are the edges of the frame
  std::unordered_map<std::uint32_t, Slot> slot_across_;  // of the edges that cross its beginning
  // At the current vertex: edges that end there and that start there, from left to right.
  std::vector<EdgeId> ending_;
  std::vector<EdgeId> starting_;
};

Trapezoidation::Trapezoidation() = default;
Trapezoidation::~Trapezoidation() = default;
Trapezoidation::Trapezoidation(Trapezoidation&&) noexcept = default;
Trapezoidation& Trapezoidation::operator=(Trapezoidation&&) noexcept = default;

bool Trapezoidation::build(const Boundary& boundary, TrapezoidalGraph& graph) {
  boundary_ = &boundary;
  graph_ = &graph;
  is_even_odd_ = true;
  return sweep(1);
}

bool Trapezoidation::build(const Boundary& boundary, const FaceBeyond& face_beyond,
                           TrapezoidalGraph& graph, unsigned threads) {
  boundary_ = &boundary;
  graph_ = &graph;
  is_even_odd_ = false;
  if (!sweep(threads)) return false;
  name_faces(face_beyond);
  return true;
}

bool Trapezoidation::sweep(unsigned threads) {
  std::atomic<bool> is_failed = false;
  const auto use_slabs = [this](std::size_t count) {
    used_ = count;
    while (slabs_.size() < used_) slabs_.push_back(std::make_unique<Slab>(*this));
  };
  if (threads <= 1) {
    use_slabs(1);
    start(0);
    slabs_[0]->begin(VertexId(1), VertexId(boundary_->vertices.size() - 1));
    return slabs_[0]->run(is_failed) && join_slabs();
  }
  const std::vector<VertexId> firsts = cut_into_slabs(*boundary_, threads);
  use_slabs(firsts.size() - 1);
  std::vector<std::vector<EdgeId>> across(used_);
  for_each_in_parallel(used_ - 1, threads, [&](std::size_t i) {
    across[i + 1] = edges_across(*boundary_, firsts[i + 1]);
  });
  std::size_t guests = 0;
  for (std::size_t i = 1; i < used_; ++i) guests += across[i].size() + 1;
  start(guests);
  slabs_[0]->begin(firsts[0], firsts[1]);
  NodeId first_guest(graph_->nodes_.size() - guests);
  for (std::size_t i = 1; i < used_; ++i) {
    slabs_[i]->begin(firsts[i], firsts[i + 1], std::move(across[i]), first_guest);
    first_guest = slabs_[i]->guest(slabs_[i]->guests());
  }
  for_each_in_parallel(used_, threads, [&](std::size_t i) {
    if (!slabs_[i]->run(is_failed)) is_failed = true;
  });
  return !is_failed && join_slabs();
}

/// Makes room for so many nodes in addition to those of the graph.
void Trapezoidation::start(std::size_t guests) {
  const std::size_t count = boundary_->edges.size();
  const std::size_t vertices = boundary_->vertices.size();
  TrapezoidalGraph& g = *graph_;
  g.vertices_ = boundary_->vertices;
  g.face_count_ = 1;
  g.corners_.clear();
  // One node exists at the beginning, and each vertex opens one more node than edges that start
  // there.
  const std::size_t nodes = count + vertices - 1 + guests;
  if (nodes > g.nodes_.capacity()) {
    g.nodes_ = {};                         // no content has to be kept
    g.nodes_.reserve(nodes + nodes / 64);  // the next graph may have some more
  }
  g.nodes_.resize(nodes);
  g.edges_.resize(count + 2);
  for (std::size_t e = 0; e < count; ++e) {
    const Boundary::Ends ends = boundary_->edges[EdgeId(e)];
    g.edges_[EdgeId(e)] = Edge{{ends.upper, ends.lower}, {}, {kOutside, kOutside}};
  }
  const VertexId last(vertices - 1);
  for (const Side side : {kLeft, kRight}) {
    g.frame_[side] = EdgeId(count + static_cast<std::size_t>(side));
    g.edges_[g.frame_[side]] = Edge{{VertexId(0), last}, {}, {kOutside, kOutside}};
  }
  slot_of_.resize(count + 2);
}

/// The nodes with which a slab began continue those left open by the slab above. At the end only
/// the frame remains, and the last node ends at infinity.
bool Trapezoidation::join_slabs() {
  TrapezoidalGraph& g = *graph_;
  const std::size_t nodes = boundary_->edges.size() + boundary_->vertices.size() - 1;
  joined_.assign(g.nodes_.size() - nodes, NodeId());
  for (std::size_t i = 1; i < used_; ++i) join(*slabs_[i - 1], *slabs_[i]);
  const VertexId last(boundary_->vertices.size() - 1);
  slabs_[used_ - 1]->for_each_open([&](EdgeId left, NodeId n) {
    if (n.value >= nodes) n = joined_[n.value - nodes];
    g.nodes_[n].end[kDown] = last;
    g.edges_[left].extreme[kRight][kDown] = n;
    g.edges_[g.frame_[kRight]].extreme[kLeft][kDown] = n;
  });
  g.nodes_.resize(nodes);
  return true;
}

void Trapezoidation::join(const Slab& upper, const Slab& lower) {
  TrapezoidalGraph& g = *graph_;
  const std::size_t nodes = boundary_->edges.size() + boundary_->vertices.size() - 1;
  std::size_t i = 0;
  upper.for_each_open([&](EdgeId, NodeId open) {
    const NodeId n = open.value >= nodes ? joined_[open.value - nodes] : open;
    const NodeId guest_id = lower.guest(i++);
    const Node& guest = g.nodes_[guest_id];
    joined_[guest_id.value - nodes] = n;
    if (guest.end[kDown].is_none()) return;  // open at the end of that slab, too
    Node& node = g.nodes_[n];
    node.end[kDown] = guest.end[kDown];
    for (const Side s : {kLeft, kRight}) {
      const NodeId next = guest.link[s][kDown];
      node.link[s][kDown] = next;
      if (!next.is_none()) g.nodes_[next].link[s][kUp] = n;
      NodeId& extreme = g.edges_[guest.edge[s]].extreme[opposite(s)][kDown];
      if (extreme == guest_id) extreme = n;
    }
  });
}

/// For each edge, from the face on the left of its beginning.
void Trapezoidation::name_faces(const FaceBeyond& face_beyond) {
  TrapezoidalGraph& g = *graph_;
  for (std::size_t i = 1; i + 1 < boundary_->vertices.size(); ++i) {
    const VertexId v(i);
    const auto edges = boundary_->edges_at(v);
    starting_.clear();
    EdgeId ending;
    for (const EdgeId e : edges) {
      if (boundary_->edges[e].upper == v) {
        starting_.push_back(e);
      } else {
        ending = e;
      }
    }
    if (starting_.empty()) continue;
    if (edges.size() == 2 && starting_.size() == 1) {
      const Edge& above = g.edges_[ending];
      Edge& edge = g.edges_[starting_.front()];
      edge.face[kLeft] = above.face[kLeft];
      edge.face[kRight] = above.face[kRight];
      continue;
    }
    sort_around(*boundary_, v, starting_);
    const NodeId beside = g.edges_[starting_.front()].extreme[kLeft][kUp];
    FaceId face = g.edges_[g.nodes_[beside].edge[kLeft]].face[kRight];
    for (const EdgeId e : starting_) {
      Edge& edge = g.edges_[e];
      edge.face[kLeft] = face;
      edge.face[kRight] = face = face_beyond(e, face);
    }
  }
}

void Trapezoidation::Slab::begin(VertexId first, VertexId last) {
  first_ = first;
  last_ = last;
  across_.clear();
  guests_ = 0;
  may_run_ = true;
  slot_across_.clear();
  status_.clear();
  status_[Status::kFirst].edge = owner_.graph_->frame_[kLeft];
  status_[Status::kLast].edge = owner_.graph_->frame_[kRight];
  next_node_ = NodeId(0);
  open(Status::kFirst, VertexId(0));
}

void Trapezoidation::Slab::begin(VertexId first, VertexId last, std::vector<EdgeId> across,
                                 NodeId first_guest) {
  first_ = first;
  last_ = last;
  across_ = std::move(across);
  first_guest_ = first_guest;
  guests_ = across_.size() + 1;
  slot_across_.clear();
  status_.clear();
  status_[Status::kFirst].edge = owner_.graph_->frame_[kLeft];
  status_[Status::kLast].edge = owner_.graph_->frame_[kRight];
  Slot slot = Status::kFirst;
  for (const EdgeId e : across_) {
    slot = status_.insert_after(slot, {e, {}});
    slot_across_[e.value] = slot;
  }
  may_run_ = true;
  slot = Status::kFirst;
  for (std::size_t i = 0; i < guests_; ++i, slot = status_.next(slot)) {
    open_as(slot, guest(i), VertexId());
    may_run_ = may_run_ && is_apart(slot, status_.next(slot));
  }
  std::size_t opened = first.value;
  for (const Boundary::Ends& ends : owner_.boundary_->edges) opened += ends.upper < first;
  next_node_ = NodeId(opened);
}

bool Trapezoidation::Slab::run(std::atomic<bool>& is_failed) {
  if (!may_run_) return false;
  for (std::size_t v = first_.value; v < last_.value; ++v) {
    if (!sweep_vertex(VertexId(v)) || is_failed.load(std::memory_order_relaxed)) return false;
  }
  return true;
}

bool Trapezoidation::Slab::sweep_vertex(VertexId v) {
  const auto edges = owner_.boundary_->edges_at(v);
  if (edges.size() == 2) {
    const bool first_ends = owner_.boundary_->edges[edges[0]].lower == v;
    const bool second_ends = owner_.boundary_->edges[edges[1]].lower == v;
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
bool Trapezoidation::Slab::sweep_regular(VertexId v, EdgeId ending, EdgeId starting) {
  TrapezoidalGraph& g = *owner_.graph_;
  const Slot slot = slot_of(ending);
  const Slot left = status_.prev(slot);
  const Slot right = status_.next(slot);
  const NodeId upper_left = close(left, v);
  const NodeId upper_right = close(slot, v);
  status_[slot].edge = starting;
  owner_.slot_of_[starting.value] = slot;
  if (owner_.is_even_odd_) {
    Edge& edge = g.edges_[starting];
    edge.face[kLeft] = g.edges_[ending].face[kLeft];
    edge.face[kRight] = g.edges_[ending].face[kRight];
  }
  link(kLeft, upper_left, open(left, v));
  link(kRight, upper_right, open(slot, v));
  return is_apart(left, slot) && is_apart(slot, right);
}

// Any number of edges end and start at v:
//
//     \   |   /   ending_
//   ---------v---------
//       /    \    starting_
bool Trapezoidation::Slab::sweep_general(VertexId v) {
  ending_.clear();
  starting_.clear();
  for (const EdgeId e : owner_.boundary_->edges_at(v)) {
    (owner_.boundary_->edges[e].lower == v ? ending_ : starting_).push_back(e);
  }
  if (!sort_around(*owner_.boundary_, v, starting_)) return false;

  Slot left;
  if (ending_.empty()) {
    left = locate(v);
    if (left == Status::kNoSlot) return false;
  } else {
    const Slot first = first_of_run(v, ending_.size());
    if (first == Status::kNoSlot) return false;
    left = status_.prev(first);
  }
  TrapezoidalGraph& g = *owner_.graph_;
  const NodeId upper_left = close(left, v);
  NodeId upper_right = upper_left;
  for (std::size_t i = 0; i < ending_.size(); ++i) {
    const Slot slot = status_.next(left);
    upper_right = close(slot, v);
    status_.remove(slot);
  }
  const Slot right = status_.next(left);

  // Unless the caller provides faces, they alternate from left to right (even-odd).
  const bool is_even_odd = owner_.is_even_odd_;
  Slot last = left;
  FaceId face = is_even_odd ? g.edges_[status_[left].edge].face[kRight] : kOutside;
  for (const EdgeId e : starting_) {
    last = status_.insert_after(last, {e, {}});
    owner_.slot_of_[e.value] = last;
    if (!is_even_odd) continue;
    g.edges_[e].face[kLeft] = face;
    face = face == kOutside ? 1 : kOutside;
    g.edges_[e].face[kRight] = face;
  }
  link(kLeft, upper_left, open(left, v));
  for (Slot slot = status_.next(left); slot != right; slot = status_.next(slot)) open(slot, v);
  link(kRight, upper_right, status_[last].right);

  if (last == left) return is_apart(left, right);
  return is_apart(left, status_.next(left)) && is_apart(last, right);
}

Trapezoidation::Slab::Slot Trapezoidation::Slab::first_of_run(VertexId v, std::size_t count) const {
  const auto ends_at_v = [&](Slot slot) {
    return slot > Status::kLast && owner_.boundary_->edges[status_[slot].edge].lower == v;
  };
  Slot first = slot_of(ending_.front());
  while (ends_at_v(status_.prev(first))) first = status_.prev(first);
  Slot slot = first;
  for (std::size_t i = 1; i < count; ++i) {
    slot = status_.next(slot);
    if (!ends_at_v(slot)) return Status::kNoSlot;
  }
  return first;
}

NodeId Trapezoidation::Slab::close(Slot slot, VertexId v) {
  TrapezoidalGraph& g = *owner_.graph_;
  const NodeId n = status_[slot].right;
  Node& node = g.nodes_[n];
  node.end[kDown] = v;
  Edge& left = g.edges_[node.edge[kLeft]];
  Edge& right = g.edges_[node.edge[kRight]];
  if (left.end[kDown] == v) left.extreme[kRight][kDown] = n;
  if (right.end[kDown] == v) right.extreme[kLeft][kDown] = n;
  return n;
}

NodeId Trapezoidation::Slab::open(Slot slot, VertexId v) {
  TrapezoidalGraph& g = *owner_.graph_;
  const NodeId n = next_node_;
  next_node_ = NodeId(n.value + std::size_t{1});
  open_as(slot, n, v);
  const Node& node = g.nodes_[n];
  Edge& left = g.edges_[node.edge[kLeft]];
  Edge& right = g.edges_[node.edge[kRight]];
  if (left.end[kUp] == v) left.extreme[kRight][kUp] = n;
  if (right.end[kUp] == v) right.extreme[kLeft][kUp] = n;
  return n;
}

void Trapezoidation::Slab::open_as(Slot slot, NodeId n, VertexId v) {
  Node node;
  node.end[kUp] = v;
  node.edge[kLeft] = status_[slot].edge;
  node.edge[kRight] = status_[status_.next(slot)].edge;
  owner_.graph_->nodes_[n] = node;
  status_[slot].right = n;
}

void Trapezoidation::Slab::link(Side side, NodeId upper, NodeId lower) {
  owner_.graph_->nodes_[upper].link[side][kDown] = lower;
  owner_.graph_->nodes_[lower].link[side][kUp] = upper;
}

Trapezoidation::Slab::Slot Trapezoidation::Slab::locate(VertexId v) const {
  const Point p = owner_.boundary_->vertices[v];
  const Status::Location found = status_.locate([&](const Crossing& crossing) {
    const Boundary::Ends e = owner_.boundary_->edges[crossing.edge];
    return side_of(owner_.boundary_->vertices[e.upper], owner_.boundary_->vertices[e.lower], p);
  });
  return found.on == Status::kNoSlot ? found.left : Status::kNoSlot;
}

bool Trapezoidation::Slab::is_apart(Slot left, Slot right) const {
  if (left == Status::kFirst || right == Status::kLast) return true;
  const Boundary::Ends a = owner_.boundary_->edges[status_[left].edge];
  const Boundary::Ends b = owner_.boundary_->edges[status_[right].edge];
  if (a.lower == b.lower) return true;
  const auto& at = owner_.boundary_->vertices;
  return a.lower < b.lower ? side_of(at[b.upper], at[b.lower], at[a.lower]) < 0
                           : side_of(at[a.upper], at[a.lower], at[b.lower]) > 0;
}

}  // namespace trapeze
