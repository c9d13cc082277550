// How far along its loop every vertex lies, noted anew whenever a loop has become much shorter, so
// that dashes along its outline have their lengths at every tolerance.
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
  /// `graph` is as it was built, and weighed by `stack`; both must outlive the use of this.
  void begin(const TrapezoidalGraph& graph, const PriorityStack& stack);

  /// Appends what has changed since the last call: all milestones of every loop, and of every arc
  /// between junctions, whose length has shrunk so much that dashes would be visibly shortened, and
  /// all at the first call. The vertex of the number n becomes vertex base + n - 1. Does nothing
  /// while only few vertices have gone since then.
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
