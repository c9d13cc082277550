#include "core/layer/level_span.h"

#include "core/layer/class_dust.h"
#include "core/layer/layer_contents.h"

namespace trapeze {
namespace {

bool is_drawn(std::span<const std::uint8_t> classes, std::uint32_t row) {
  return classes.empty() || classes[row] != kNotDrawn;
}

/// For an edge or a mote, testing its box is enough.
bool box_meets(const MeshView& mesh, std::uint32_t trapezoid, const Box& box) {
  const MeshTrapezoid& t = mesh.trapezoids[trapezoid];
  Box around;
  for (const std::uint32_t edge : {t.left, t.right}) {
    around.include(mesh.vertices[mesh.edges[edge].upper]);
    around.include(mesh.vertices[mesh.edges[edge].lower]);
  }
  return around.intersects(box);
}

}  // namespace

void LevelSpan::clear() {
  polygons_.clear();
  edges_.clear();
  motes_.clear();
  grains_.clear();
}

bool LevelSpan::find(const Layer& layer, std::span<const std::uint8_t> classes,
                     const LevelSpanSelection& selection, std::uint64_t most) {
  clear();
  const LayerContents& c = layer.contents();
  const auto& [finest, coarsest] = selection.levels;
  std::uint64_t estimate = 0;
  for (const auto& segment : c.segments) {
    estimate += segment->polygons.estimate(selection.box, coarsest, finest);
  }
  if (estimate > most) return false;
  const auto select = [&](const MeshIndex& index, const Box& box, const LevelRange& levels,
                          const auto& take) {
    ranges_.clear();
    index.select(box, levels.coarsest, levels.finest, c.lifespans, ranges_);
    for_each_trapezoid(ranges_, take);
  };
  const auto take_to = [&](std::vector<std::uint32_t>& ids, const auto& meets_box) {
    return [&](std::uint32_t i) {
      const std::uint32_t row = layer.feature_of(i);
      if (row != Layer::kNoFeature && !is_drawn(classes, row)) return;
      if (meets_box(i)) ids.push_back(i);
    };
  };
  const MeshView& mesh = layer.mesh();
  for (const auto& segment : c.segments) {
    select(segment->polygons, selection.box, selection.levels,
           take_to(polygons_, [&](std::uint32_t i) {
             return meets(mesh, mesh.trapezoids[i], selection.box);
           }));
    if (selection.has_edges) {
      select(segment->horizontal_edges, selection.box, selection.levels,
             take_to(edges_, [&](std::uint32_t i) { return box_meets(mesh, i, selection.box); }));
    }
    if (!selection.has_motes) continue;
    for (const MeshIndex* index : {&segment->motes, &segment->merged_motes}) {
      select(
          *index, selection.dust_box, selection.resolutions,
          take_to(motes_, [&](std::uint32_t i) { return box_meets(mesh, i, selection.dust_box); }));
    }
  }
  if (!selection.births.is_empty()) {
    layer.grains().visit(selection.dust_box, selection.births, [&](const FeatureGrain& grain) {
      if (is_drawn(classes, grain.row)) grains_.push_back(&grain);
    });
  }
  return true;
}

void LevelSpan::narrow(const Layer& layer, const LevelSpan& from,
                       const LevelSpanSelection& selection) {
  clear();
  const LayerContents& c = layer.contents();
  const MeshView& mesh = layer.mesh();
  for (const std::uint32_t i : from.polygons_) {
    if (!selection.levels.meets(c.lifespans[i])) continue;
    if (meets(mesh, mesh.trapezoids[i], selection.box)) polygons_.push_back(i);
  }
  for (const std::uint32_t i : from.edges_) {
    if (!selection.levels.meets(c.lifespans[i])) continue;
    if (box_meets(mesh, i, selection.box)) edges_.push_back(i);
  }
  for (const std::uint32_t i : from.motes_) {
    if (!selection.resolutions.meets(c.lifespans[i])) continue;
    if (box_meets(mesh, i, selection.dust_box)) motes_.push_back(i);
  }
  for (const FeatureGrain* grain : from.grains_) {
    if (!selection.births.contains(grain->born)) continue;
    if (grain->box().intersects(selection.dust_box)) grains_.push_back(grain);
  }
}

}  // namespace trapeze
