#include "core/layer/layer.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/layer/layer_contents.h"

namespace trapeze {

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
  contents_->polygon_index.select(selection.box, selection.level, selection.level,
                                  contents_->lifespans, ranges);
  if (selection.small == SmallPolygons::dust) select_dust(selection, ranges);
}

// What the tolerance has made that is larger than pixels are the later_births().
void Layer::select_dust(const Selection& selection, std::vector<TrapezoidRange>& ranges) const {
  const Level resolution = std::min(selection.level, selection.pixel_level);
  const LayerContents& c = *contents_;
  c.mote_index.select(selection.box, resolution, resolution, c.lifespans, ranges);
  c.merged_mote_index.select(selection.box, resolution, resolution, c.lifespans, ranges);
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
  contents_->horizontal_edge_index.select(box, level, level, contents_->lifespans, ranges);
}

std::uint64_t Layer::estimate_trapezoids(const Selection& selection) const {
  const LayerContents& c = *contents_;
  const auto& [box, level, pixel_level, small] = selection;
  const std::uint64_t polygons = c.polygon_index.estimate(box, level, level);
  if (small != SmallPolygons::dust) return polygons;
  const Level resolution = std::min(level, pixel_level);
  return polygons + c.mote_index.estimate(box, resolution, resolution) +
         c.merged_mote_index.estimate(box, resolution, resolution);
}

std::uint64_t Layer::estimate_horizontal_edges(const Selection& selection) const {
  const LayerContents& c = *contents_;
  return c.horizontal_edge_index.estimate(selection.box, selection.level, selection.level);
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
  // Dust comes last, and may take area away.
  const bool has_dust =
      !ranges.empty() && ranges.back().first + ranges.back().count > contents_->feature_of.size();
  return !has_dust && cover_box(contents_->view, ranges, selection.box);
}

void Layer::small_polygons(const Selection& selection, std::vector<Box>& places) const {
  places.clear();
  std::vector<TrapezoidRange> ranges;
  select_dust(selection, ranges);
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
  if (row >= c.outline_ends.size()) return;
  for (std::uint32_t i = row == 0 ? 0 : c.outline_ends[row - 1]; i < c.outline_ends[row]; ++i) {
    const std::uint32_t begin = i == 0 ? 0 : c.ring_ends[i - 1];
    // Of a file that is cut off while it is mapped, ends may read as zero.
    const std::uint32_t end = std::max(begin, c.ring_ends[i]);
    rings.add(std::span(c.outline_points).subspan(begin, end - begin));
  }
}

std::uint32_t Layer::feature_of(std::uint32_t trapezoid) const {
  return trapezoid < contents_->feature_of.size() ? contents_->feature_of[trapezoid] : kNoFeature;
}

LayerSize Layer::size() const {
  return contents_->size;
}

std::size_t Layer::memory() const {
  const LayerContents& c = *contents_;
  return c.vertices.memory() + c.edges.memory() + c.loop_sizes.memory() +
         c.milestone_ends.memory() + c.milestones.memory() + c.milestone_levels.memory() +
         c.trapezoids.memory() + c.lifespans.memory() + c.feature_of.memory() +
         c.outline_points.memory() + c.ring_ends.memory() + c.outline_ends.memory() +
         c.feature_units.memory() + c.group_units.memory() + c.group_members.memory() +
         c.group_overlaps.memory() + c.polygon_index.memory() + c.horizontal_edge_index.memory() +
         c.mote_index.memory() + c.merged_mote_index.memory() + c.grains.memory() +
         c.overlaps.memory();
}

}  // namespace trapeze
