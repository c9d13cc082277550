// A note of a milestone, recorded while a graph is simplified.
#pragma once

#include <cstdint>

#include "core/grid/tolerance.h"
#include "core/mesh/outline.h"

namespace trapeze {

/// The milestone of a vertex from a level on; see OutlineView.
struct MilestoneNote {
  std::uint32_t vertex = 0;
  Milestone milestone = 0;
  Level level = 0;
};

}  // namespace trapeze
