#include "core/graph/edit_log.h"

#include <cassert>

namespace trapeze {
namespace {

template <class IdType, class Record>
void swap_forwards(Table<IdType, Record>& table, std::vector<EditLog::Kept<IdType, Record>>& kept,
                   std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) std::swap(table[kept[i].id], kept[i].record);
}

template <class IdType, class Record>
void swap_backwards(Table<IdType, Record>& table, std::vector<EditLog::Kept<IdType, Record>>& kept,
                    std::size_t begin, std::size_t end) {
  for (std::size_t i = end; i > begin; --i) std::swap(table[kept[i - 1].id], kept[i - 1].record);
}

template <class T>
std::size_t bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

}  // namespace

void EditLog::begin() {
  assert(applied_ == edits_.size());
  edits_.push_back({nodes_.size(), edges_.size(), corners_.size()});
  ++applied_;
}

EditLog::Start EditLog::end_of(std::size_t edit) const {
  return edit + 1 < edits_.size() ? edits_[edit + 1]
                                  : Start{nodes_.size(), edges_.size(), corners_.size()};
}

// A record may be kept twice in one edit. Swapping in reverse order restores its first value, and
// swapping forwards again its last.
void EditLog::take_back() {
  assert(applied_ == edits_.size());
  revert();
  const Start begin = edits_.back();
  nodes_.resize(begin.nodes);
  edges_.resize(begin.edges);
  corners_.resize(begin.corners);
  edits_.pop_back();
}

void EditLog::revert() {
  assert(applied_ > 0);
  --applied_;
  const Start from = edits_[applied_];
  const Start to = end_of(applied_);
  swap_backwards(graph_->nodes_, nodes_, from.nodes, to.nodes);
  swap_backwards(graph_->edges_, edges_, from.edges, to.edges);
  swap_backwards(graph_->corners_, corners_, from.corners, to.corners);
}

void EditLog::apply() {
  assert(applied_ < edits_.size());
  const Start from = edits_[applied_];
  const Start to = end_of(applied_);
  swap_forwards(graph_->nodes_, nodes_, from.nodes, to.nodes);
  swap_forwards(graph_->edges_, edges_, from.edges, to.edges);
  swap_forwards(graph_->corners_, corners_, from.corners, to.corners);
  ++applied_;
}

std::span<const EditLog::Kept<NodeId, Node>> EditLog::touched_nodes() const {
  return std::span(nodes_).subspan(edits_.back().nodes);
}

std::span<const EditLog::Kept<EdgeId, Edge>> EditLog::touched_edges() const {
  return std::span(edges_).subspan(edits_.back().edges);
}

void EditLog::forget() {
  assert(applied_ == edits_.size());
  edits_.clear();
  nodes_.clear();
  edges_.clear();
  corners_.clear();
  applied_ = 0;
}

std::size_t EditLog::memory() const {
  return bytes(edits_) + bytes(nodes_) + bytes(edges_) + bytes(corners_);
}

}  // namespace trapeze
