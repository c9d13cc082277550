#include "core/mesh/outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trapeze {
namespace {

constexpr double kSizesPerOctave = 8;
constexpr double kLeastStretch = 0.75;
constexpr double kMostStretch = 8;
constexpr double kMostOfFirst = 1.5;      // of the presumed length of the first edge of a loop
constexpr double kMilestoneRounding = 2;  // cells: milestones are whole ones

double length_of(const MeshView& mesh, const MeshEdge& edge) {
  const Point a = mesh.vertices[edge.upper];
  const Point b = mesh.vertices[edge.lower];
  const double x = static_cast<double>(b.x) - a.x;
  const double y = static_cast<double>(b.y) - a.y;
  return std::sqrt(x * x + y * y);
}

/// The lengths at the ends of an edge that has one end where lengths restart: the first or the last
/// edge of its loop. First the length at that end, then at the other one.
struct AlongEnds {
  double beginning;
  double other;
};
AlongEnds along_from_beginning(Milestone other, double length) {
  const double along = other;
  const bool is_first = along >= kLeastStretch * length - kMilestoneRounding &&
                        along <= kMostOfFirst * length + kMilestoneRounding;
  if (is_first) return {0, along};
  return {along + length, along};
}

}  // namespace

LoopSize loop_size_of(double area) {
  const double extent = std::sqrt(area * 4 / std::numbers::pi);
  if (extent <= 1) return 0;
  const double size = std::round(kSizesPerOctave * std::log2(extent));
  return static_cast<LoopSize>(std::min(size, double{kLoopSizes - 1}));
}

double extent_of(LoopSize size) {
  return std::exp2(size / kSizesPerOctave);
}

Milestone OutlineView::milestone(std::uint32_t vertex, Level level) const {
  if (vertex >= milestone_ends.size()) return 0;
  const std::uint32_t begin = vertex == 0 ? 0 : milestone_ends[vertex - 1];
  // In a file that is truncated while it is mapped, ends may read as zero.
  std::uint32_t i = std::max(begin, milestone_ends[vertex]);
  while (i > begin + 1 && milestone_levels[i - 1] > level) --i;
  return i > begin ? milestones[i - 1] : 0;
}

Stretch stretch_between(Milestone from, Milestone to, double edge_length) {
  const double length = static_cast<std::int32_t>(to - from);
  const bool fits = std::abs(length) >= kLeastStretch * edge_length - kMilestoneRounding &&
                    std::abs(length) <= kMostStretch * edge_length + kMilestoneRounding;
  return {fits, length};
}

AlongEdge along_edge(const MeshView& mesh, const OutlineView& outline, std::uint32_t edge,
                     Level level) {
  const MeshEdge& ends = mesh.edges[edge];
  const double length = length_of(mesh, ends);
  const Milestone upper = outline.milestone(ends.upper, level);
  const Milestone lower = outline.milestone(ends.lower, level);
  if (upper == 0 && lower == 0) return {0, length};
  if (upper == 0) {
    const auto [beginning, other] = along_from_beginning(lower, length);
    return {beginning, other};
  }
  if (lower == 0) {
    const auto [beginning, other] = along_from_beginning(upper, length);
    return {other, beginning};
  }
  const Stretch stretch = stretch_between(upper, lower, length);
  const double along = upper;
  return {along, along + (stretch.fits ? stretch.length : length)};
}

}  // namespace trapeze
