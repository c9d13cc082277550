// The distance of every vertex along its loop, noted again whenever a loop has become much shorter,
// so that dashes along its outline have the right length at every tolerance.
//
// Thread-safety: one thread at a time.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "core/adapt/milestone_note.h"
#include "core/mesh/outline.h"

namespace trapeze {

class Milestones {
 public:
  /// `graph` is as built and weighed by `stack`. Both must outlive the use of this object.
  void begin(const TrapezoidalGraph& graph, const PriorityStack& stack);

  /// Appends the changes since the last call: all milestones of every loop, and of every arc
  /// between junctions, whose length has shrunk so much that dashes would be visibly shorter. The
  /// first call appends all milestones. Vertex n of the graph becomes vertex base + n - 1. Does
  /// nothing while only few vertices have been removed since.
  void note(Level level, std::uint32_t base, std::vector<MilestoneNote>& notes);

 private:
  void count_visits();
  void note_from(CornerId first);
  bool is_worn() const;
  void number_loop();
  bool begins_anew(CornerId c) const;
  double length_from(CornerId c) const;

  const TrapezoidalGraph* graph_ = nullptr;
  const PriorityStack* stack_ = nullptr;
  std::uint64_t removals_ = 0;  // at the last call
  bool is_first_ = true;
  Table<VertexId, Milestone> milestones_;
  Table<VertexId, std::uint8_t> visits_;
  Table<CornerId, std::uint8_t> is_noted_;
  std::vector<CornerId> loop_;
  // Of the present call.
  Level level_ = 0;
  std::uint32_t base_ = 0;
  std::vector<MilestoneNote>* notes_ = nullptr;
};

}  // namespace trapeze
