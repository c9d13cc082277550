#include "core/layer/overview.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/grid/item_count.h"
#include "core/layer/dust.h"
#include "core/layer/layer_arrays.h"
#include "core/layer/layer_contents.h"
#include "core/layer/motes_of_grains.h"
#include "core/mesh/mesh_index.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kLeftOut = 0xffffffff;  // instead of a number in the overview

/// Trapezoids, or horizontal edges, in the order of the parts.
struct Pieces {
  std::vector<MeshTrapezoid> trapezoids;
  std::vector<Lifespan> lifespans;
  std::vector<std::uint32_t> rows;
};

/// A mote of a part as a grain without length, which is laid out as the same mote again.
Grain grain_of_mote(const MeshView& mesh, const MeshTrapezoid& t, Level born) {
  const Box box = box_of(mesh, t);
  const Point middle{static_cast<std::int32_t>((std::int64_t{box.min_x} + box.max_x) / 2),
                     static_cast<std::int32_t>((std::int64_t{box.min_y} + box.max_y) / 2)};
  const double area =
      (static_cast<double>(box.max_x) - box.min_x) * (static_cast<double>(box.max_y) - box.min_y);
  const bool is_hole =
      mesh.vertices[mesh.edges[t.left].upper].x > mesh.vertices[mesh.edges[t.right].upper].x;
  return {{middle, middle}, is_hole ? -area : area, born, 0};
}

}  // namespace

struct OverviewBuilder::State {
  Level first_level = 0;
  LayerOptions options;
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<LoopSize> loop_sizes;
  std::vector<std::uint32_t> milestone_ends;
  std::vector<Milestone> milestones;
  std::vector<Level> milestone_levels;
  Pieces polygons;
  Pieces horizontal_edges;
  std::vector<Grain> motes;  // of the parts, at the first level
  std::vector<FeatureGrain> grains;
  std::vector<FeatureOverlap> overlaps;
  FeatureTable features;
  Box bounds;
  std::size_t vertices_of_parts = 0;
};

/// One part, with the numbers of its rows, edges and vertices in the overview.
class OverviewBuilder::Adding {
 public:
  Adding(const Layer& part, State& state)
      : state_(state),
        part_(part),
        from_(arrays_of(part)),
        rows_(from_.cells.ids.size(), kLeftOut),
        edges_(from_.edges.size(), kLeftOut),
        vertices_(from_.vertices.size(), kLeftOut) {}

  void add() {
    number_rows();
    const std::size_t polygons = from_.feature_of.size() - from_.horizontal_edges;
    for (std::size_t i = 0; i < from_.feature_of.size(); ++i) {
      const Lifespan lifespan = from_.lifespans[i];
      if (lifespan.dies <= state_.first_level) continue;
      Pieces& pieces = i < polygons ? state_.polygons : state_.horizontal_edges;
      const MeshTrapezoid& t = from_.trapezoids[i];
      pieces.trapezoids.push_back({vertex(t.top), vertex(t.bottom), edge(t.left), edge(t.right)});
      pieces.lifespans.push_back(lifespan);
      pieces.rows.push_back(rows_[from_.feature_of[i]]);
    }
    for (std::size_t i = from_.feature_of.size(); i < from_.trapezoids.size(); ++i) {
      if (!from_.lifespans[i].contains(state_.first_level)) continue;
      state_.motes.push_back(grain_of_mote(part_.mesh(), from_.trapezoids[i], state_.first_level));
    }
    for (FeatureGrain grain : from_.grains) {
      if (grain.born <= state_.first_level) continue;
      grain.row = rows_[grain.row];
      state_.grains.push_back(grain);
    }
    for (const FeatureOverlap& pair : from_.overlaps) {
      if (rows_[pair.row] == kLeftOut || rows_[pair.other] == kLeftOut) continue;
      state_.overlaps.push_back({rows_[pair.row], rows_[pair.other], pair.width, pair.along});
    }
    state_.bounds.include(from_.bounds);
    state_.vertices_of_parts += from_.size.vertices;
    state_.options = from_.options;
  }

 private:
  /// Numbers the features of which something is left, in their original order: later ones are drawn
  /// over others.
  void number_rows() {
    for (std::size_t i = 0; i < from_.feature_of.size(); ++i) {
      if (from_.lifespans[i].dies > state_.first_level) rows_[from_.feature_of[i]] = 0;
    }
    for (const FeatureGrain& grain : from_.grains) {
      if (grain.born > state_.first_level) rows_[grain.row] = 0;
    }
    for (std::size_t old = 0; old < rows_.size(); ++old) {
      if (rows_[old] != kLeftOut) rows_[old] = state_.features.append(from_.cells.ids[old], {});
    }
  }

  std::uint32_t edge(std::uint32_t old) {
    if (edges_[old] != kLeftOut) return edges_[old];
    const MeshEdge& e = from_.edges[old];
    const MeshEdge now{vertex(e.upper), vertex(e.lower)};
    edges_[old] = static_cast<std::uint32_t>(state_.edges.size());
    state_.edges.push_back(now);
    state_.loop_sizes.push_back(from_.outline.loop_size(old));
    require_countable(state_.edges.size(), "versions of edges");
    return edges_[old];
  }

  std::uint32_t vertex(std::uint32_t old) {
    if (vertices_[old] != kLeftOut) return vertices_[old];
    vertices_[old] = static_cast<std::uint32_t>(state_.vertices.size());
    state_.vertices.push_back(from_.vertices[old]);
    require_countable(state_.vertices.size(), "vertices");
    const OutlineView& outline = from_.outline;
    if (old < outline.milestone_ends.size()) {
      const std::uint32_t begin = old == 0 ? 0 : outline.milestone_ends[old - 1];
      for (std::uint32_t i = begin; i < outline.milestone_ends[old]; ++i) {
        state_.milestones.push_back(outline.milestones[i]);
        state_.milestone_levels.push_back(outline.milestone_levels[i]);
      }
    }
    require_countable(state_.milestones.size(), "milestones");
    state_.milestone_ends.push_back(static_cast<std::uint32_t>(state_.milestones.size()));
    return vertices_[old];
  }

  State& state_;
  const Layer& part_;
  const LayerArrays from_;
  std::vector<std::uint32_t> rows_;
  std::vector<std::uint32_t> edges_;
  std::vector<std::uint32_t> vertices_;
};

namespace {

/// Appends the pieces in order for an index.
void append_in_order(const Pieces& pieces, const MeshView& mesh, Pieces& all) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  order.reserve(pieces.trapezoids.size());
  for (std::uint32_t i = 0; i < pieces.trapezoids.size(); ++i) {
    order.emplace_back(order_key(box_of(mesh, pieces.trapezoids[i]), pieces.lifespans[i]), i);
  }
  std::ranges::sort(order);
  for (const auto& [key, i] : order) {
    all.trapezoids.push_back(pieces.trapezoids[i]);
    all.lifespans.push_back(pieces.lifespans[i]);
    all.rows.push_back(pieces.rows[i]);
  }
}

/// Appends the single motes, or the merged ones, in order for an index.
void append_motes(const std::vector<Mote>& motes, bool are_merged, std::vector<Point>& vertices,
                  std::vector<MeshEdge>& edges, Pieces& all) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < motes.size(); ++i) {
    if (motes[i].is_merged == are_merged) order.emplace_back(order_key(motes[i]), i);
  }
  std::ranges::sort(order);
  for (const auto& [key, i] : order) {
    append_mote(motes[i], vertices, edges, all.trapezoids);
    all.lifespans.push_back(motes[i].lifespan);
  }
}

}  // namespace

OverviewBuilder::OverviewBuilder(Level first_level) : state_(std::make_unique<State>()) {
  state_->first_level = first_level;
  state_->features = FeatureTable(std::vector<Field>{});
}
OverviewBuilder::~OverviewBuilder() = default;

void OverviewBuilder::add(const Layer& part) {
  Adding(part, *state_).add();
}

std::unique_ptr<Layer> OverviewBuilder::finish(unsigned threads) {
  State& state = *state_;
  auto layer = std::make_unique<LayerContents>();
  Pieces all;
  const MeshView drawn{0, state.vertices, state.edges, {}};
  append_in_order(state.polygons, drawn, all);
  const auto polygons = static_cast<std::uint32_t>(all.trapezoids.size());
  append_in_order(state.horizontal_edges, drawn, all);
  const auto edges = static_cast<std::uint32_t>(all.trapezoids.size());

  std::vector<Grain> grains = std::exchange(state.motes, {});
  for (const Grain& grain : uncovered(state.grains)) grains.push_back(grain);
  const std::vector<Mote> motes = settle(grains, state.vertices_of_parts);
  require_countable(state.vertices.size() + 4 * motes.size(), "vertices");
  require_countable(state.edges.size() + 2 * motes.size(), "versions of edges");
  require_countable(all.trapezoids.size() + motes.size(), "versions of trapezoids");
  layer->size.vertices = state.vertices.size();
  layer->size.edges = state.edges.size();
  append_motes(motes, false, state.vertices, state.edges, all);
  const auto singles = static_cast<std::uint32_t>(all.trapezoids.size());
  append_motes(motes, true, state.vertices, state.edges, all);
  const auto end = static_cast<std::uint32_t>(all.trapezoids.size());
  layer->size.trapezoids = polygons;
  layer->size.motes = end - edges;

  layer->options = state.options;
  layer->bounds = state.bounds;
  layer->vertices = std::move(state.vertices);
  layer->edges = std::move(state.edges);
  layer->loop_sizes = std::move(state.loop_sizes);
  layer->milestone_ends = std::move(state.milestone_ends);
  layer->milestones = std::move(state.milestones);
  layer->milestone_levels = std::move(state.milestone_levels);
  layer->trapezoids = std::move(all.trapezoids);
  layer->lifespans = std::move(all.lifespans);
  layer->feature_of = std::move(all.rows);
  layer->features = std::move(state.features);
  std::ranges::sort(state.overlaps, {},
                    [](const FeatureOverlap& pair) { return std::pair(pair.row, pair.other); });
  layer->overlaps = OverlapTable(std::move(state.overlaps), layer->features.size());
  std::ranges::stable_sort(state.grains, {},
                           [](const FeatureGrain& grain) { return order_key(grain); });
  layer->grains = GrainIndex(std::move(state.grains));
  layer->view = MeshView{new_mesh_id(), layer->vertices, layer->edges, layer->trapezoids};
  layer->outline = OutlineView{layer->loop_sizes, layer->milestone_ends, layer->milestones,
                               layer->milestone_levels};
  const auto index = [&layer, threads](std::uint32_t from, std::uint32_t to) {
    return MeshIndex(layer->view, {from, to - from}, layer->lifespans, threads);
  };
  layer->segments.push_back(std::make_shared<const MeshSegment>(MeshSegment{
      index(0, polygons), index(polygons, edges), index(edges, singles), index(singles, end)}));
  return std::make_unique<Layer>(std::move(layer));
}

}  // namespace trapeze
