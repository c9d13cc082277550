#include "core/layer/layer_patcher.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/grid/item_count.h"
#include "core/grid/shared_array.h"
#include "core/layer/dust.h"
#include "core/layer/layer_contents.h"
#include "core/mesh/mesh_index.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;
constexpr Lifespan kNever{0, 0};

using Owners = std::vector<std::shared_ptr<const void>>;

/// The rings of a feature as they are numbered in its layer.
RingRange rings_of(const LayerContents& layer, std::uint32_t row) {
  if (const auto moved = layer.moved_outlines.find(row); moved != layer.moved_outlines.end()) {
    return moved->second;
  }
  if (row >= layer.outline_ends.size()) return {};
  return {row == 0 ? 0 : layer.outline_ends[row - 1], layer.outline_ends[row]};
}

/// Around features of the layer as they were built.
Box box_of_features(const Layer& layer, std::span<const std::uint32_t> rows) {
  Rings rings;
  for (const std::uint32_t row : rows) layer.append_outline(row, rings);
  Box box;
  for (const Point p : rings.points) box.include(p);
  return box;
}

/// The box and so many cells around it, as far as there is a grid.
Box with_margin(const Box& box, double margin) {
  const auto cell = [](double v) {
    return static_cast<std::int32_t>(
        std::clamp(v, static_cast<double>(kGridMin), static_cast<double>(kGridMax)));
  };
  return {cell(box.min_x - margin), cell(box.min_y - margin), cell(box.max_x + margin),
          cell(box.max_y + margin)};
}

Grain grain_of(const FeatureGrain& grain) {
  return {{grain.from, grain.to}, grain.area(), grain.born, grain.row};
}

/// What small loops left behind that motes stand for.
std::vector<Grain> uncovered(std::span<const FeatureGrain> grains) {
  std::vector<Grain> result;
  for (const FeatureGrain& grain : grains) {
    if (grain.is_covered == 0) result.push_back(grain_of(grain));
  }
  return result;
}

std::size_t count_vertices(const LayerContents& layer) {
  std::size_t vertices = 0;
  for (const FeatureUnit& unit : layer.feature_units) vertices += unit.vertices;
  for (const GroupUnit& unit : layer.group_units) vertices += unit.vertices;
  return vertices;
}

BuiltUnitsView units_of(const LayerContents& layer) {
  return {{layer.feature_units.data(), layer.feature_units.size()},
          {layer.group_units.data(), layer.group_units.size()},
          {layer.group_members.data(), layer.group_members.size()},
          {layer.group_overlaps.data(), layer.group_overlaps.size()}};
}

std::invalid_argument several_of(std::int64_t id) {
  return std::invalid_argument("there are several features of the id " + std::to_string(id));
}

/// Which rows are to be replaced, and which of them may be others than before.
struct RowMarks {
  std::vector<std::uint8_t> is_replaced;  // by row
  std::vector<std::uint8_t> is_changed;   // by row

  /// Whether what is known of a pair of features holds no longer.
  bool ends(const FeatureOverlap& pair) const {
    return (is_replaced[pair.row] != 0 && is_replaced[pair.other] != 0) ||
           is_changed[pair.row] != 0 || is_changed[pair.other] != 0;
  }
};

}  // namespace

struct LayerPatcher::State {
  std::shared_ptr<const Layer> first;
  std::shared_ptr<const Layer> now;
  std::size_t patches = 0;
  int most_motes = 1;  // of a grain, in the layer as it was given

  SharedArray<Point> vertices;
  SharedArray<MeshEdge> edges;
  SharedArray<MeshTrapezoid> trapezoids;
  SharedArray<std::uint32_t> feature_of;
  SharedArray<LoopSize> loop_sizes;
  SharedArray<std::uint32_t> milestone_ends;
  SharedArray<Milestone> milestones;
  SharedArray<Level> milestone_levels;
  SharedArray<Point> outline_points;
  SharedArray<std::uint32_t> ring_ends;

  std::unordered_map<std::int64_t, std::uint32_t> row_of_id;  // of those that are gone as well
  std::vector<std::uint32_t> group_of;                        // by row; kNone
  std::vector<std::vector<std::uint32_t>> groups;             // rows

  explicit State(const LayerContents& whole)
      : vertices(whole.vertices),
        edges(whole.edges),
        trapezoids(whole.trapezoids),
        feature_of(whole.feature_of),
        loop_sizes(whole.loop_sizes),
        milestone_ends(whole.milestone_ends),
        milestones(whole.milestones),
        milestone_levels(whole.milestone_levels),
        outline_points(whole.outline_points),
        ring_ends(whole.ring_ends) {}

  const LayerContents& contents() const { return now->contents(); }

  /// Throws as the constructor of LayerPatcher does.
  void number_first() {
    const LayerContents& whole = first->contents();
    patches = 0;
    now = first;
    note_ids(whole.features);
    groups.clear();
    group_of.assign(whole.features.size(), kNone);
    note_groups(whole, [](std::uint32_t row) { return row; });
  }

  void note_ids(const FeatureTable& features) {
    row_of_id.clear();
    row_of_id.reserve(features.size());
    for (std::uint32_t row = 0; row < features.size(); ++row) {
      if (row_of_id.emplace(features.id(row), row).second) continue;
      throw several_of(features.id(row));
    }
  }

  /// `row_of` leads from rows of that layer to rows of now.
  template <typename RowOf>
  void note_groups(const LayerContents& layer, const RowOf& row_of) {
    const BuiltUnitsView units = units_of(layer);
    for (std::size_t g = 0; g < units.groups.size(); ++g) {
      std::vector<std::uint32_t>& rows = groups.emplace_back();
      for (const GroupMember& member : units.members_of(g)) {
        rows.push_back(row_of(member.row));
        group_of[rows.back()] = static_cast<std::uint32_t>(groups.size() - 1);
      }
    }
  }

  /// Around the units of which these rows are all: however much it is simplified, each stays within
  /// its own; a feature of a group may leave that of its own.
  std::vector<Box> boxes_of_units(std::span<const std::uint32_t> rows) const {
    std::vector<Box> boxes;
    std::unordered_set<std::uint32_t> done;
    for (const std::uint32_t row : rows) {
      const std::uint32_t group = group_of[row];
      if (group != kNone && !done.insert(group).second) continue;
      boxes.push_back(group == kNone ? box_of_features(*now, {&row, 1})
                                     : box_of_features(*now, groups[group]));
    }
    return boxes;
  }

  /// Contents that look at what has been appended by now.
  std::unique_ptr<LayerContents> new_contents(Owners owners) const {
    auto contents = std::make_unique<LayerContents>();
    contents->vertices = vertices.view();
    contents->edges = edges.view();
    contents->trapezoids = trapezoids.view();
    contents->feature_of = feature_of.view();
    contents->loop_sizes = loop_sizes.view();
    contents->milestone_ends = milestone_ends.view();
    contents->milestones = milestones.view();
    contents->milestone_levels = milestone_levels.view();
    contents->outline_points = outline_points.view();
    contents->ring_ends = ring_ends.view();
    owners.insert(owners.end(),
                  {vertices.owner(), edges.owner(), trapezoids.owner(), feature_of.owner(),
                   loop_sizes.owner(), milestone_ends.owner(), milestones.owner(),
                   milestone_levels.owner(), outline_points.owner(), ring_ends.owner()});
    contents->mapping = std::make_shared<const Owners>(std::move(owners));
    contents->view =
        MeshView{new_mesh_id(), contents->vertices, contents->edges, contents->trapezoids};
    contents->outline = OutlineView{contents->loop_sizes, contents->milestone_ends,
                                    contents->milestones, contents->milestone_levels};
    return contents;
  }

  void begin_with(const LayerContents& whole) {
    auto contents = new_contents({whole.mapping});
    contents->lifespans = whole.lifespans.copy();
    contents->segments = whole.segments;
    contents->grains = GrainIndex(
        std::vector<FeatureGrain>(whole.grains.grains().begin(), whole.grains.grains().end()));
    contents->overlaps = OverlapTable(
        std::vector<FeatureOverlap>(whole.overlaps.pairs().begin(), whole.overlaps.pairs().end()),
        whole.features.size());
    contents->has_all_overlaps = whole.has_all_overlaps;
    contents->size = whole.size;
    contents->options = whole.options;
    contents->outline_ends = whole.outline_ends.copy();
    contents->feature_units = whole.feature_units.copy();
    contents->group_units = whole.group_units.copy();
    contents->group_members = whole.group_members.copy();
    contents->group_overlaps = whole.group_overlaps.copy();
    contents->bounds = whole.bounds;
    contents->features = whole.features.copy();
    first = std::make_shared<const Layer>(std::move(contents));
  }
};

namespace {

/// One patch while it is made.
class Patching {
 public:
  Patching(const Layer& now, const LayerPatcher::Patch& patch,
           const std::unordered_map<std::int64_t, std::uint32_t>& row_of_id)
      : now_(now), from_(patch.features), features_(now.features().copy()) {
    number_rows(row_of_id);
    mark(patch, row_of_id);
    lifespans_.assign(now.contents().lifespans.begin(), now.contents().lifespans.end());
  }

  std::uint32_t row_of(std::uint32_t patch_row) const { return rows_[patch_row]; }
  std::span<const std::uint32_t> rows() const { return rows_; }
  std::span<const std::uint32_t> replaced() const { return replaced_; }

  /// Of all that is replaced, which are features of `units`, the trapezoids and the dust.
  void end_lives(std::span<const Box> units, int most_motes) {
    for (const Box& unit : units) end_trapezoids(unit);
    for (const FeatureGrain& grain : now_.grains().grains()) {
      if (marks_.is_replaced[grain.row] == 0 || grain.is_covered != 0) continue;
      const Grain gone = grain_of(grain);
      const int motes = count_of_motes(gone.axis, pixel_of_level(gone.born), most_motes);
      lay_out(gone.axis, gone.area, motes, [&](double x, double y, double area) {
        end_mote({x, y, area, {gone.born, kNeverDies}});
      });
    }
  }

  std::vector<Mote>& makeup() { return makeup_; }
  std::vector<Lifespan>& lifespans() { return lifespans_; }
  FeatureTable take_features() { return std::move(features_); }

  std::vector<FeatureGrain> grains() const {
    std::vector<FeatureGrain> fresh(from_.grains().grains().begin(), from_.grains().grains().end());
    for (FeatureGrain& grain : fresh) grain.row = rows_[grain.row];
    std::vector<FeatureGrain> kept;
    kept.reserve(now_.grains().grains().size() + fresh.size());
    for (const FeatureGrain& grain : now_.grains().grains()) {
      if (marks_.is_replaced[grain.row] == 0) kept.push_back(grain);
    }
    // Both are in order, as they are of layers.
    std::vector<std::size_t> places;
    std::size_t last = 0;
    for (const FeatureGrain& grain : fresh) {
      const auto place = std::upper_bound(
          kept.begin() + static_cast<std::ptrdiff_t>(last), kept.end(), order_key(grain),
          [](std::uint64_t key, const FeatureGrain& other) { return key < order_key(other); });
      last = static_cast<std::size_t>(place - kept.begin());
      places.push_back(last);
    }
    std::vector<FeatureGrain> all;
    all.reserve(kept.size() + fresh.size());
    std::size_t done = 0;
    for (std::size_t i = 0; i < fresh.size(); ++i) {
      all.insert(all.end(), kept.begin() + static_cast<std::ptrdiff_t>(done),
                 kept.begin() + static_cast<std::ptrdiff_t>(places[i]));
      done = places[i];
      all.push_back(fresh[i]);
    }
    all.insert(all.end(), kept.begin() + static_cast<std::ptrdiff_t>(done), kept.end());
    return all;
  }

  std::vector<FeatureOverlap> overlaps() const {
    std::vector<FeatureOverlap> pairs;
    for (const FeatureOverlap& pair : now_.overlaps().pairs()) {
      if (!marks_.ends(pair)) pairs.push_back(pair);
    }
    for (FeatureOverlap pair : from_.overlaps().pairs()) {
      pair.row = rows_[pair.row];
      pair.other = rows_[pair.other];
      pairs.push_back(pair);
    }
    std::ranges::sort(pairs, {}, [](const FeatureOverlap& p) { return std::pair(p.row, p.other); });
    return pairs;
  }

  /// By row.
  std::vector<bool> removed(std::size_t rows) const {
    std::vector<bool> is_removed = now_.contents().is_removed;
    is_removed.resize(rows, false);
    for (const std::uint32_t row : replaced_) is_removed[row] = true;
    for (const std::uint32_t row : rows_) is_removed[row] = false;
    return is_removed;
  }

  Box bounds() const {
    Box bounds = now_.bounds();
    bounds.include(from_.bounds());
    return bounds;
  }

 private:
  void number_rows(const std::unordered_map<std::int64_t, std::uint32_t>& row_of_id) {
    const FeatureTable& table = from_.features();
    const auto is_same = [](const Field& a, const Field& b) {
      return a.name == b.name && a.type == b.type;
    };
    if (!std::ranges::equal(table.fields(), features_.fields(), is_same)) {
      throw std::invalid_argument("the attributes are others than those of the layer");
    }
    std::unordered_set<std::int64_t> ids;
    std::vector<Value> values(table.fields().size());
    for (std::uint32_t i = 0; i < table.size(); ++i) {
      if (!ids.insert(table.id(i)).second) throw several_of(table.id(i));
      for (std::size_t field = 0; field < values.size(); ++field) {
        values[field] = table.value(i, static_cast<int>(field));
      }
      const auto known = row_of_id.find(table.id(i));
      if (known == row_of_id.end()) {
        rows_.push_back(features_.append(table.id(i), values));
      } else {
        rows_.push_back(known->second);
        features_.replace(known->second, values);
      }
    }
  }

  void mark(const LayerPatcher::Patch& patch,
            const std::unordered_map<std::int64_t, std::uint32_t>& row_of_id) {
    marks_.is_replaced.assign(features_.size(), 0);
    marks_.is_changed.assign(features_.size(), 0);
    for (const std::int64_t id : patch.ids) {
      const auto row = row_of_id.find(id);
      if (row == row_of_id.end()) continue;
      if (marks_.is_replaced[row->second]++ == 0) replaced_.push_back(row->second);
    }
    for (const std::int64_t id : patch.changed) {
      const auto row = row_of_id.find(id);
      if (row != row_of_id.end()) marks_.is_changed[row->second] = 1;
    }
  }

  void end_trapezoids(const Box& box) {
    if (box.is_empty()) return;
    ranges_.clear();
    for (const auto& segment : now_.contents().segments) {
      segment->polygons.select(box, kLastLevel, 0, lifespans_, ranges_);
      segment->horizontal_edges.select(box, kLastLevel, 0, lifespans_, ranges_);
    }
    for_each_trapezoid(ranges_, [&](std::uint32_t i) {
      if (marks_.is_replaced[now_.feature_of(i)] != 0) lifespans_[i] = kNever;
    });
  }

  /// Ends what stands for it alone; of what stands for others as well, notes what makes up for it.
  void end_mote(const Mote& mote) {
    Level from = mote.lifespan.born;
    const Box box = box_of_mote(mote.x, mote.y, std::abs(mote.area));
    ranges_.clear();
    for (const auto& segment : now_.contents().segments) {
      segment->motes.select(box, kLastLevel, 0, lifespans_, ranges_);
    }
    const MeshView& mesh = now_.mesh();
    bool is_found = false;
    for_each_trapezoid(ranges_, [&](std::uint32_t i) {
      const MeshTrapezoid& t = mesh.trapezoids[i];
      const bool is_hole =
          mesh.vertices[mesh.edges[t.left].upper].x > mesh.vertices[mesh.edges[t.right].upper].x;
      const bool is_it = !is_found && lifespans_[i].born == from && is_hole == (mote.area < 0) &&
                         box_of(mesh, t) == box;
      if (!is_it) return;
      from = std::exchange(lifespans_[i], kNever).dies;
      is_found = true;
    });
    if (from <= kLastLevel && std::abs(mote.area) >= kSmallestMote) {
      makeup_.push_back({mote.x, mote.y, -mote.area, {from, kNeverDies}, true});
    }
  }

  const Layer& now_;
  const Layer& from_;
  FeatureTable features_;
  std::vector<std::uint32_t> rows_;      // by row of the patch
  std::vector<std::uint32_t> replaced_;  // rows
  RowMarks marks_;
  std::vector<Lifespan> lifespans_;
  std::vector<Mote> makeup_;
  std::vector<TrapezoidRange> ranges_;
};

/// The motes as squares, in order for the index.
struct Squares {
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<MeshTrapezoid> trapezoids;
  std::vector<Lifespan> lifespans;
};

Squares squares_of(std::vector<Mote>& motes) {
  const auto key_of = [](const Mote& mote) {
    const Point p{static_cast<std::int32_t>(mote.x), static_cast<std::int32_t>(mote.y)};
    return order_key(Box{p.x, p.y, p.x, p.y}, mote.lifespan);
  };
  std::ranges::stable_sort(motes, {}, key_of);
  Squares squares;
  for (const Mote& mote : motes) {
    append_box(box_of_mote(mote.x, mote.y, std::abs(mote.area)), squares.vertices, squares.edges,
               squares.trapezoids);
    MeshTrapezoid& t = squares.trapezoids.back();
    if (mote.area < 0) std::swap(t.left, t.right);
    squares.lifespans.push_back(mote.lifespan);
  }
  return squares;
}

TrapezoidRange moved(TrapezoidRange range, std::size_t by) {
  return {static_cast<std::uint32_t>(range.first + by), range.count};
}

}  // namespace

LayerPatcher::LayerPatcher(const Layer& whole) : state_(std::make_unique<State>(whole.contents())) {
  const LayerContents& contents = whole.contents();
  state_->begin_with(contents);
  state_->most_motes = most_motes_of(uncovered(contents.grains.grains()), count_vertices(contents));
  state_->number_first();
}
LayerPatcher::~LayerPatcher() = default;
LayerPatcher::LayerPatcher(LayerPatcher&&) noexcept = default;
LayerPatcher& LayerPatcher::operator=(LayerPatcher&&) noexcept = default;

const std::shared_ptr<const Layer>& LayerPatcher::first() const {
  return state_->first;
}
const std::shared_ptr<const Layer>& LayerPatcher::now() const {
  return state_->now;
}
std::size_t LayerPatcher::patches() const {
  return state_->patches;
}

std::vector<std::int64_t> LayerPatcher::ids_to_build(std::span<const std::int64_t> ids,
                                                     std::span<const Box> places,
                                                     double reach) const {
  const State& state = *state_;
  const Layer& now = *state.now;
  std::vector<std::uint32_t> rows;
  const auto add_unit = [&](std::uint32_t row) {
    rows.push_back(row);
    if (state.group_of[row] == kNone) return;
    const std::vector<std::uint32_t>& group = state.groups[state.group_of[row]];
    rows.insert(rows.end(), group.begin(), group.end());
  };
  std::vector<std::int64_t> fresh;
  for (const std::int64_t id : ids) {
    const auto row = state.row_of_id.find(id);
    if (row != state.row_of_id.end()) {
      add_unit(row->second);
    } else if (std::ranges::find(fresh, id) == fresh.end()) {
      fresh.push_back(id);
    }
  }
  std::vector<std::uint32_t> near;
  std::vector<TrapezoidRange> ranges;
  for (const Box& place : places) {
    if (place.is_empty()) continue;
    const Box around = with_margin(place, reach);
    now.select({around, 0, 0, SmallPolygons::drop}, ranges);
    for_each_trapezoid(ranges, [&](std::uint32_t i) {
      if (box_of(now.mesh(), now.mesh().trapezoids[i]).intersects(around)) {
        near.push_back(now.feature_of(i));
      }
    });
  }
  const auto leave_one_of_each = [](std::vector<std::uint32_t>& items) {
    std::ranges::sort(items);
    items.erase(std::unique(items.begin(), items.end()), items.end());
  };
  leave_one_of_each(near);
  for (const std::uint32_t row : near) add_unit(row);
  leave_one_of_each(rows);
  std::vector<std::int64_t> all;
  for (const std::uint32_t row : rows) all.push_back(now.features().id(row));
  all.insert(all.end(), fresh.begin(), fresh.end());
  return all;
}

void LayerPatcher::start_over() {
  state_->number_first();
}

LayerChanges LayerPatcher::apply(const Patch& patch) {
  State& state = *state_;
  const LayerContents& before = state.contents();
  const LayerContents& from = patch.features.contents();
  Patching patching(*state.now, patch, state.row_of_id);
  std::vector<Box> places = state.boxes_of_units(patching.replaced());
  patching.end_lives(places, state.most_motes);
  const Squares makeup = squares_of(patching.makeup());

  // What follows goes behind whatever there is, and pads what is shorter: arrays that end before
  // dust does, and those of a patch that failed.
  const std::size_t v = state.vertices.size();
  const std::size_t e = state.edges.size();
  const std::size_t t = state.trapezoids.size();
  require_countable(v + from.vertices.size() + makeup.vertices.size(), "vertices");
  require_countable(e + from.edges.size() + makeup.edges.size(), "versions of edges");
  require_countable(t + from.trapezoids.size() + makeup.trapezoids.size(),
                    "versions of trapezoids");
  require_countable(state.milestones.size() + from.milestones.size(), "milestones");
  require_countable(state.outline_points.size() + from.outline_points.size(), "vertices of rings");
  const auto append_edges = [&state](std::span<const MeshEdge> edges, std::size_t by) {
    std::vector<MeshEdge> shifted(edges.begin(), edges.end());
    for (MeshEdge& edge : shifted) {
      edge.upper += static_cast<std::uint32_t>(by);
      edge.lower += static_cast<std::uint32_t>(by);
    }
    state.edges.append(shifted);
  };
  const auto append_trapezoids = [&state](std::span<const MeshTrapezoid> trapezoids,
                                          std::size_t vertices, std::size_t edges) {
    std::vector<MeshTrapezoid> shifted(trapezoids.begin(), trapezoids.end());
    for (MeshTrapezoid& trapezoid : shifted) {
      trapezoid.top += static_cast<std::uint32_t>(vertices);
      trapezoid.bottom += static_cast<std::uint32_t>(vertices);
      trapezoid.left += static_cast<std::uint32_t>(edges);
      trapezoid.right += static_cast<std::uint32_t>(edges);
    }
    state.trapezoids.append(shifted);
  };
  const auto append_ends = [](std::span<const std::uint32_t> ends, std::size_t by,
                              SharedArray<std::uint32_t>& to) {
    std::vector<std::uint32_t> shifted(ends.begin(), ends.end());
    for (std::uint32_t& end : shifted) end += static_cast<std::uint32_t>(by);
    to.append(shifted);
  };
  state.vertices.append(from.vertices);
  append_edges(from.edges, v);
  append_trapezoids(from.trapezoids, v, e);
  append_edges(makeup.edges, state.vertices.size());
  append_trapezoids(makeup.trapezoids, state.vertices.size(), e + from.edges.size());
  state.vertices.append(makeup.vertices);

  std::vector<Lifespan>& lifespans = patching.lifespans();
  lifespans.resize(t, kNever);
  lifespans.insert(lifespans.end(), from.lifespans.begin(), from.lifespans.end());
  lifespans.insert(lifespans.end(), makeup.lifespans.begin(), makeup.lifespans.end());

  std::vector<std::uint32_t> rows(from.feature_of.begin(), from.feature_of.end());
  for (std::uint32_t& row : rows) row = row == Layer::kNoFeature ? row : patching.row_of(row);
  state.feature_of.append(t - state.feature_of.size(), Layer::kNoFeature);
  state.feature_of.append(rows);

  state.loop_sizes.append(e - state.loop_sizes.size(), LoopSize{kLoopSizes - 1});
  state.loop_sizes.append(from.loop_sizes);
  const auto milestones = static_cast<std::uint32_t>(state.milestones.size());
  state.milestone_ends.append(v - state.milestone_ends.size(), milestones);
  append_ends(from.milestone_ends, milestones, state.milestone_ends);
  state.milestones.append(from.milestones);
  state.milestone_levels.append(milestones - state.milestone_levels.size(), Level{0});
  state.milestone_levels.append(from.milestone_levels);

  const auto rings = static_cast<std::uint32_t>(state.ring_ends.size());
  append_ends(from.ring_ends, state.outline_points.size(), state.ring_ends);
  state.outline_points.append(from.outline_points);

  auto next = state.new_contents({state.first});
  next->moved_outlines = before.moved_outlines;
  for (std::uint32_t row = 0; row < from.features.size(); ++row) {
    const RingRange range = rings_of(from, row);
    next->moved_outlines[patching.row_of(row)] = {rings + range.begin, rings + range.end};
  }
  next->outline_ends = StoredArray<std::uint32_t>::looking_at(state.first->contents().outline_ends);
  next->features = patching.take_features();
  next->is_removed = patching.removed(next->features.size());
  next->grains = GrainIndex(patching.grains());
  next->overlaps = OverlapTable(patching.overlaps(), next->features.size());
  next->has_all_overlaps = before.has_all_overlaps && from.has_all_overlaps;
  next->size = {before.size.vertices + from.size.vertices,
                before.size.trapezoids + from.size.trapezoids, before.size.edges + from.size.edges,
                before.size.motes + from.size.motes + makeup.trapezoids.size()};
  next->options = before.options;
  next->bounds = patching.bounds();
  next->segments = before.segments;
  const auto index = [&](TrapezoidRange range, std::size_t by) {
    return MeshIndex(next->view, moved(range, by), lifespans);
  };
  const MeshSegment& segment = from.first_segment();
  next->segments.push_back(std::make_shared<const MeshSegment>(
      MeshSegment{index(segment.polygons.range(), t), index(segment.horizontal_edges.range(), t),
                  index(segment.motes.range(), t), index(segment.merged_motes.range(), t)}));
  const TrapezoidRange rest{0, static_cast<std::uint32_t>(makeup.trapezoids.size())};
  if (rest.count > 0) {
    next->segments.push_back(std::make_shared<const MeshSegment>(
        MeshSegment{{}, {}, {}, index(rest, t + from.trapezoids.size())}));
  }
  next->lifespans = std::move(lifespans);

  for (const std::uint32_t row : patching.replaced()) state.group_of[row] = kNone;
  state.group_of.resize(next->features.size(), kNone);
  state.note_groups(from, [&patching](std::uint32_t row) { return patching.row_of(row); });
  for (std::uint32_t row = 0; row < from.features.size(); ++row) {
    state.row_of_id.emplace(from.features.id(row), patching.row_of(row));
  }
  ++state.patches;
  state.now = std::make_shared<const Layer>(std::move(next));
  const std::vector<Box> fresh = state.boxes_of_units(patching.rows());
  places.insert(places.end(), fresh.begin(), fresh.end());
  LayerChanges changes;
  for (const Box& place : places) {
    if (!place.is_empty()) changes.places.push_back({place, Lifespan()});
  }
  return changes;
}

}  // namespace trapeze
