#include "core/layer/layer_arrays.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "core/grid/for_each_in_parallel.h"
#include "core/layer/layer_contents.h"

namespace trapeze {
namespace {

constexpr std::size_t kMostIndexable = 0xffffffff;  // what 32-bit indices can distinguish

/// Whether holds(item) is true for all items, checked on all cores.
template <typename T, typename Holds>
bool all_of(std::span<const T> items, const Holds& holds) {
  std::atomic<bool> result = true;
  const std::size_t pieces = (items.size() + kItemsAtOnce - 1) / kItemsAtOnce;
  for_each_in_parallel(pieces, pieces, [&](std::size_t piece) {
    const std::size_t begin = piece * kItemsAtOnce;
    bool holds_here = true;  // no early exit, so that the loop can be vectorized
    for (const T& item : items.subspan(begin, std::min(kItemsAtOnce, items.size() - begin))) {
      holds_here &= holds(item);
    }
    if (!holds_here) result = false;
  });
  return result;
}

constexpr auto kIsOnGrid = [](Point p) {
  return p.x >= kGridMin && p.x <= kGridMax && p.y >= kGridMin && p.y <= kGridMax;
};

bool is_sorted_up_to(std::span<const std::uint32_t> ends, std::size_t end) {
  return std::ranges::is_sorted(ends) && (ends.empty() || ends.back() <= end);
}

/// Then the trapezoid lies between its edges: nothing is divided by zero, and no point is off the
/// grid.
bool lies_between_its_edges(const LayerArrays& a, const MeshTrapezoid& t) {
  const std::int32_t top = a.vertices[t.top].y;
  const std::int32_t bottom = a.vertices[t.bottom].y;
  const auto spans = [&](const MeshEdge& edge) {
    return a.vertices[edge.upper].y <= top && bottom <= a.vertices[edge.lower].y;
  };
  return top <= bottom && spans(a.edges[t.left]) && spans(a.edges[t.right]);
}

void check_mesh(const LayerArrays& a) {
  const std::size_t vertices = a.vertices.size();
  const std::size_t edges = a.edges.size();
  require_valid(std::max({vertices, edges, a.trapezoids.size()}) <= kMostIndexable,
                "there is too much of it");
  require_valid(all_of(a.vertices, kIsOnGrid), "a vertex is not on the grid");
  require_valid(
      all_of(a.edges,
             [vertices](const MeshEdge& e) { return e.upper < vertices && e.lower < vertices; }),
      "an end of an edge is not there");
  require_valid(all_of(a.trapezoids,
                       [&](const MeshTrapezoid& t) {
                         return t.top < vertices && t.bottom < vertices && t.left < edges &&
                                t.right < edges && lies_between_its_edges(a, t);
                       }),
                "a trapezoid does not lie between its edges");
  require_valid(a.lifespans.size() == a.trapezoids.size(), "there is not one lifespan a trapezoid");
}

void check_outline(const LayerArrays& a) {
  const OutlineView& outline = a.outline;
  require_valid(outline.loop_sizes.size() <= a.edges.size(), "there are loops without edges");
  require_valid(outline.milestone_ends.size() <= a.vertices.size() &&
                    is_sorted_up_to(outline.milestone_ends, outline.milestones.size()) &&
                    outline.milestone_levels.size() == outline.milestones.size(),
                "milestones are not in order");
}

void check_features(const LayerArrays& a) {
  const std::size_t rows = a.cells.ids.size();
  require_valid(a.feature_of.size() <= a.trapezoids.size(), "there is dust that has a feature");
  require_valid(all_of(a.feature_of, [rows](std::uint32_t row) { return row < rows; }),
                "the feature of a trapezoid is not there");
  require_valid(all_of(a.grains,
                       [rows](const FeatureGrain& grain) {
                         return grain.row < rows && grain.born <= kLastLevel &&
                                grain.is_covered <= 1 && kIsOnGrid(grain.from) &&
                                kIsOnGrid(grain.to);
                       }),
                "a grain of dust has no feature or no place");
  require_valid(a.outline_ends.size() <= rows, "there are outlines without a feature");
  require_valid(is_sorted_up_to(a.outline_ends, a.ring_ends.size()), "outlines are not in order");
  require_valid(is_sorted_up_to(a.ring_ends, a.outline_points.size()), "rings are not in order");
  require_valid(all_of(a.outline_points, kIsOnGrid), "a point of an outline is not on the grid");
}

void check_units(const LayerArrays& a) {
  const std::size_t rows = a.cells.ids.size();
  const BuiltUnitsView& units = a.units;
  const auto is_row = [rows](const auto& unit) { return unit.row < rows; };
  require_valid(all_of(units.features, is_row) && all_of(units.members, is_row),
                "the feature of a unit is not there");
  const auto is_sorted = [&units](auto end, std::size_t all) {
    return std::ranges::is_sorted(units.groups, {}, end) &&
           (units.groups.empty() ? 0 : units.groups.back().*end) == all;
  };
  require_valid(is_sorted(&GroupUnit::members_end, units.members.size()) &&
                    is_sorted(&GroupUnit::overlaps_end, units.overlaps.size()),
                "groups are not in order");
}

void check_sums(const LayerArrays& a) {
  require_valid(a.single_motes <= a.trapezoids.size() - a.feature_of.size(),
                "there is too much dust");
  require_valid(a.horizontal_edges <= a.feature_of.size() &&
                    a.size.trapezoids == a.feature_of.size() - a.horizontal_edges &&
                    a.size.motes == a.trapezoids.size() - a.feature_of.size(),
                "the sums are not those of the trapezoids");
  const Box& box = a.bounds;
  require_valid(box == Box() || (!box.is_empty() && kIsOnGrid({box.min_x, box.min_y}) &&
                                 kIsOnGrid({box.max_x, box.max_y})),
                "the bounds are not on the grid");
}

TrapezoidRange between(std::size_t begin, std::size_t end) {
  return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin)};
}

template <typename T>
void look_at(std::span<const T> items, StoredArray<T>& array) {
  array = StoredArray<T>::looking_at(items);
}

}  // namespace

LayerArrays arrays_of(const Layer& layer) {
  const LayerContents& c = layer.contents();
  const MeshSegment& segment = c.first_segment();
  LayerArrays arrays;
  arrays.vertices = c.vertices;
  arrays.edges = c.edges;
  arrays.trapezoids = c.trapezoids;
  arrays.lifespans = c.lifespans;
  arrays.feature_of = c.feature_of;
  arrays.outline = c.outline;
  arrays.polygon_index = segment.polygons.entries();
  arrays.mote_index = segment.motes.entries();
  arrays.merged_mote_index = segment.merged_motes.entries();
  arrays.horizontal_edge_index = segment.horizontal_edges.entries();
  arrays.grains = c.grains.grains();
  arrays.overlaps = c.overlaps.pairs();
  arrays.has_all_overlaps = c.has_all_overlaps;
  arrays.outline_points = c.outline_points;
  arrays.ring_ends = c.ring_ends;
  arrays.outline_ends = c.outline_ends;
  arrays.units = c.units();
  arrays.cells = c.features.cells();
  arrays.fields.assign(c.features.fields().begin(), c.features.fields().end());
  arrays.horizontal_edges = segment.horizontal_edges.range().count;
  arrays.single_motes = segment.motes.range().count;
  arrays.size = c.size;
  arrays.bounds = c.bounds;
  arrays.options = c.options;
  return arrays;
}

std::unique_ptr<Layer> layer_from(const LayerArrays& arrays, std::shared_ptr<const void> mapping) {
  check_mesh(arrays);
  check_outline(arrays);
  check_features(arrays);
  check_units(arrays);
  check_sums(arrays);
  auto layer = std::make_unique<LayerContents>();
  layer->mapping = std::move(mapping);
  look_at(arrays.vertices, layer->vertices);
  look_at(arrays.edges, layer->edges);
  look_at(arrays.trapezoids, layer->trapezoids);
  look_at(arrays.lifespans, layer->lifespans);
  look_at(arrays.feature_of, layer->feature_of);
  look_at(arrays.outline.loop_sizes, layer->loop_sizes);
  look_at(arrays.outline.milestone_ends, layer->milestone_ends);
  look_at(arrays.outline.milestones, layer->milestones);
  look_at(arrays.outline.milestone_levels, layer->milestone_levels);
  layer->outline = arrays.outline;
  look_at(arrays.outline_points, layer->outline_points);
  look_at(arrays.ring_ends, layer->ring_ends);
  look_at(arrays.outline_ends, layer->outline_ends);
  look_at(arrays.units.features, layer->feature_units);
  look_at(arrays.units.groups, layer->group_units);
  look_at(arrays.units.members, layer->group_members);
  look_at(arrays.units.overlaps, layer->group_overlaps);
  const std::size_t horizontal_edges = arrays.feature_of.size();
  const std::size_t polygons = horizontal_edges - arrays.horizontal_edges;
  const std::size_t singles = horizontal_edges + arrays.single_motes;
  layer->segments.push_back(std::make_shared<const MeshSegment>(MeshSegment{
      MeshIndex(between(0, polygons), arrays.polygon_index),
      MeshIndex(between(polygons, horizontal_edges), arrays.horizontal_edge_index),
      MeshIndex(between(horizontal_edges, singles), arrays.mote_index),
      MeshIndex(between(singles, arrays.trapezoids.size()), arrays.merged_mote_index)}));
  layer->grains = GrainIndex(StoredArray<FeatureGrain>::looking_at(arrays.grains));
  layer->overlaps = OverlapTable(StoredArray<FeatureOverlap>::looking_at(arrays.overlaps),
                                 arrays.cells.ids.size());
  layer->has_all_overlaps = arrays.has_all_overlaps;
  layer->features = FeatureTable(arrays.fields, arrays.cells);
  layer->view = MeshView{new_mesh_id(), layer->vertices, layer->edges, layer->trapezoids};
  layer->size = arrays.size;
  layer->bounds = arrays.bounds;
  layer->options = arrays.options;
  return std::make_unique<Layer>(std::move(layer));
}

}  // namespace trapeze
