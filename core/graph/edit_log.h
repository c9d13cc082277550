// Edit records: the only way to change a trapezoidal graph, and the way to undo a change.
//
// An edit is one removal. An operator requests each node, edge and corner that it is going to
// change from the log, and the log keeps the previous value. Reverting an edit swaps the kept
// values with those in the graph, last to first; applying it again swaps them once more, first to
// last. This one mechanism makes undo exact for every operator (paper, section 3.2).
//
// Thread-safety: none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/graph/trapezoidal_graph.h"

namespace trapeze {

/// A part of a graph: the edges and nodes that begin and end at vertices from `first` to `last`, in
/// sweep order, except those that are held or touch something held.
struct EditReach {
  VertexId first;
  VertexId last;
  const Table<VertexId, std::uint8_t>* held_vertices = nullptr;
  const Table<EdgeId, std::uint8_t>* held_edges = nullptr;

  bool covers(VertexId v) const { return first <= v && v <= last && (*held_vertices)[v] == 0; }
  bool covers(const Node& node) const {
    return covers(node.end[kUp]) && covers(node.end[kDown]) &&
           (*held_edges)[node.edge[kLeft]] == 0 && (*held_edges)[node.edge[kRight]] == 0;
  }
};

class EditLog {
 public:
  template <class IdType, class Record>
  struct Kept {
    IdType id;
    Record record;
  };

  /// From now on, all changes to `graph`, which must outlive the log, are made through the log.
  explicit EditLog(TrapezoidalGraph& graph) : graph_(&graph) {}

  /// Thrown by an edit that would change a record out of reach.
  struct OutOfReach {};
  /// From now on, edits change no record out of `reach`, which must outlive the log. Other threads
  /// may edit the same graph through other logs at the same time if the reaches have no vertex in
  /// common.
  void confine_to(const EditReach& reach) { reach_ = &reach; }

  /// Starts a new edit. Precondition: every earlier edit is applied.
  void begin();

  /// Returns the record to be changed and keeps its present value. Valid until the graph is
  /// rebuilt.
  Node& edit(NodeId n) {
    if (reach_ != nullptr && !reach_->covers(graph_->node(n))) throw OutOfReach();
    return keep(n, graph_->nodes_, nodes_);
  }
  Edge& edit(EdgeId e) {
    if (reach_ != nullptr && !covers(e)) throw OutOfReach();
    return keep(e, graph_->edges_, edges_);
  }
  Corner& edit(CornerId c) { return keep(c, graph_->corners_, corners_); }

  /// Number of edits recorded, and number of edits applied at present (counted from the first).
  std::size_t size() const { return edits_.size(); }
  std::size_t applied() const { return applied_; }

  /// Reverts the last recorded edit and discards it. Precondition: it is applied.
  void take_back();

  /// Reverts the last applied edit. Precondition: there is one.
  void revert();
  /// Applies the first edit that is not applied. Precondition: there is one.
  void apply();

  /// The nodes and edges that the last recorded edit changed; some may occur more than once.
  std::span<const Kept<NodeId, Node>> touched_nodes() const;
  std::span<const Kept<EdgeId, Edge>> touched_edges() const;

  /// Discards all edits; the present graph can no longer be reverted. Memory is kept for reuse.
  void forget();

  std::size_t memory() const;

 private:
  struct Start {  // start of an edit in each kind of record
    std::size_t nodes;
    std::size_t edges;
    std::size_t corners;
  };

  template <class IdType, class Record>
  Record& keep(IdType id, Table<IdType, Record>& table, std::vector<Kept<IdType, Record>>& kept) {
    Record& record = table[id];
    kept.push_back({id, record});
    return record;
  }

  Start end_of(std::size_t edit) const;
  bool covers(EdgeId e) const {
    const Edge& edge = graph_->edge(e);
    return reach_->covers(edge.end[kUp]) && reach_->covers(edge.end[kDown]) &&
           (*reach_->held_edges)[e] == 0;
  }

  TrapezoidalGraph* graph_;
  const EditReach* reach_ = nullptr;
  std::vector<Start> edits_;
  std::size_t applied_ = 0;
  std::vector<Kept<NodeId, Node>> nodes_;
  std::vector<Kept<EdgeId, Edge>> edges_;
  std::vector<Kept<CornerId, Corner>> corners_;
};

}  // namespace trapeze
