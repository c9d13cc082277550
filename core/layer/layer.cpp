#include "core/layer/layer.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/layer/layer_contents.h"

namespace trapeze {
namespace {

// Anything larger than a pixel because of the tolerance belongs to the later_births().
Level resolution_of(const Layer::Selection& selection) {
  return std::min(selection.level, selection.pixel_level);
}

void select_dust(const MeshSegment& segment, const Layer::Selection& selection,
                 std::span<const Lifespan> lifespans, std::vector<TrapezoidRange>& ranges) {
  const Level resolution = resolution_of(selection);
  segment.motes.select(selection.box, resolution, resolution, lifespans, ranges);
  segment.merged_motes.select(selection.box, resolution, resolution, lifespans, ranges);
}

}  // namespace

Layer::Layer(std::unique_ptr<const LayerContents> contents) : contents_(std::move(contents)) {}
Layer::~Layer() = default;

const FeatureTable& Layer::features() const {
  return contents_->features;
}
const Box& Layer::bounds() const {
  return contents_->bounds;
}
const MeshView& Layer::mesh() const {
  return contents_->view;
}
std::span<const Lifespan> Layer::lifespans() const {
  return contents_->lifespans;
}
const OutlineView& Layer::outline() const {
  return contents_->outline;
}

void Layer::select(const Selection& selection, std::vector<TrapezoidRange>& ranges) const {
  ranges.clear();
  const std::span<const Lifespan> lifespans = contents_->lifespans;
  for (const auto& segment : contents_->segments) {
    segment->polygons.select(selection.box, selection.level, selection.level, lifespans, ranges);
    if (selection.small == SmallPolygons::dust) {
      select_dust(*segment, selection, lifespans, ranges);
    }
  }
}

void Layer::keep_uppermost(std::vector<TrapezoidRange>& ranges) const {
  if (!overlaps().are_any_in_common()) return;
  std::vector<TrapezoidRange> kept;
  std::optional<std::uint32_t> uppermost;
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    if (uppermost && !have_in_common(*uppermost, i)) append_trapezoid(*uppermost, kept);
    uppermost = i;
  });
  if (uppermost) append_trapezoid(*uppermost, kept);
  ranges.swap(kept);
}

bool Layer::have_in_common(std::uint32_t one, std::uint32_t other) const {
  const std::uint32_t row = feature_of(one);
  const std::uint32_t other_row = feature_of(other);
  return row != kNoFeature && other_row != kNoFeature && row != other_row &&
         mesh().trapezoids[one] == mesh().trapezoids[other];
}

void Layer::select_horizontal_edges(const Box& box, Level level,
                                    std::vector<TrapezoidRange>& ranges) const {
  ranges.clear();
  for (const auto& segment : contents_->segments) {
    segment->horizontal_edges.select(box, level, level, contents_->lifespans, ranges);
  }
}

std::uint64_t Layer::estimate_trapezoids(const Selection& selection) const {
  const auto& [box, level, pixel_level, small] = selection;
  const Level resolution = resolution_of(selection);
  std::uint64_t sum = 0;
  for (const auto& segment : contents_->segments) {
    sum += segment->polygons.estimate(box, level, level);
    if (small != SmallPolygons::dust) continue;
    sum += segment->motes.estimate(box, resolution, resolution) +
           segment->merged_motes.estimate(box, resolution, resolution);
  }
  return sum;
}

std::uint64_t Layer::estimate_horizontal_edges(const Selection& selection) const {
  std::uint64_t sum = 0;
  for (const auto& segment : contents_->segments) {
    sum += segment->horizontal_edges.estimate(selection.box, selection.level, selection.level);
  }
  return sum;
}

GrainIndex::Births Layer::Selection::later_births() const {
  return {static_cast<Level>(std::min(level, pixel_level) + 1), level};
}

const GrainIndex& Layer::grains() const {
  return contents_->grains;
}

const OverlapTable& Layer::overlaps() const {
  return contents_->overlaps;
}

bool Layer::has_all_overlaps() const {
  return contents_->has_all_overlaps;
}

bool Layer::fill_box(const Selection& selection, std::span<const TrapezoidRange> ranges) const {
  // Dust may subtract area.
  return !have_dust(ranges) && cover_box(contents_->view, ranges, selection.box);
}

// In content that was built whole, dust comes last.
bool Layer::have_dust(std::span<const TrapezoidRange> ranges) const {
  if (ranges.empty()) return false;
  if (contents_->is_whole())
    return feature_of(ranges.back().first + ranges.back().count - 1) == kNoFeature;
  return std::ranges::any_of(ranges, [this](const TrapezoidRange& range) {
    for (std::uint32_t i = 0; i < range.count; ++i) {
      if (feature_of(range.first + i) == kNoFeature) return true;
    }
    return false;
  });
}

void Layer::small_polygons(const Selection& selection, std::vector<Box>& places) const {
  places.clear();
  std::vector<TrapezoidRange> ranges;
  for (const auto& segment : contents_->segments) {
    select_dust(*segment, selection, contents_->lifespans, ranges);
  }
  const MeshView& mesh = contents_->view;
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    const MeshTrapezoid& t = mesh.trapezoids[i];
    const bool is_hole =
        mesh.vertices[mesh.edges[t.left].upper].x > mesh.vertices[mesh.edges[t.right].upper].x;
    if (!is_hole) places.push_back(box_of(mesh, t));
  });
}

void Layer::append_outline(std::uint32_t row, Rings& rings) const {
  const LayerContents& c = *contents_;
  const RingRange range = c.rings_of(row);
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    const std::uint32_t begin = i == 0 ? 0 : c.ring_ends[i - 1];
    // In a file that is truncated while it is mapped, ends may read as zero.
    const std::uint32_t end = std::max(begin, c.ring_ends[i]);
    rings.add(std::span(c.outline_points).subspan(begin, end - begin));
  }
}

std::uint32_t Layer::feature_of(std::uint32_t trapezoid) const {
  return trapezoid < contents_->feature_of.size() ? contents_->feature_of[trapezoid] : kNoFeature;
}

bool Layer::is_removed(std::uint32_t row) const {
  return row < contents_->is_removed.size() && contents_->is_removed[row];
}

LayerSize Layer::size() const {
  return contents_->size;
}

std::size_t Layer::memory() const {
  const LayerContents& c = *contents_;
  std::size_t indexes = 0;
  for (const auto& segment : c.segments) {
    indexes += segment->polygons.memory() + segment->horizontal_edges.memory() +
               segment->motes.memory() + segment->merged_motes.memory();
  }
  return indexes + c.vertices.memory() + c.edges.memory() + c.loop_sizes.memory() +
         c.milestone_ends.memory() + c.milestones.memory() + c.milestone_levels.memory() +
         c.trapezoids.memory() + c.lifespans.memory() + c.feature_of.memory() +
         c.outline_points.memory() + c.ring_ends.memory() + c.outline_ends.memory() +
         c.feature_units.memory() + c.group_units.memory() + c.group_members.memory() +
         c.group_overlaps.memory() + c.grains.memory() + c.overlaps.memory();
}

}  // namespace trapeze
