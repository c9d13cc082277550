#include "core/layer/layer_patcher.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/grid/box_margin.h"
#include "core/grid/item_count.h"
#include "core/grid/shared_array.h"
#include "core/layer/dust.h"
#include "core/layer/layer_contents.h"
#include "core/layer/motes_of_grains.h"
#include "core/layer/overlaps.h"
#include "core/mesh/mesh_index.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;
constexpr Lifespan kNever{0, 0};
constexpr double kTouch = 8;  // cells: borders nearer to each other run along each other

using Owners = std::vector<std::shared_ptr<const void>>;

/// The bounding box of a feature of the layer as built.
Box box_of_feature(const LayerContents& layer, std::uint32_t row) {
  const RingRange rings = layer.rings_of(row);
  Box box;
  for (std::uint32_t i = rings.begin; i < rings.end; ++i) {
    for (std::uint32_t p = i == 0 ? 0 : layer.ring_ends[i - 1]; p < layer.ring_ends[i]; ++p) {
      box.include(layer.outline_points[p]);
    }
  }
  return box;
}

void leave_one_of_each(std::vector<std::uint32_t>& items) {
  std::ranges::sort(items);
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

std::invalid_argument several_of(std::int64_t id) {
  return std::invalid_argument("there are several features of the id " + std::to_string(id));
}

/// Trapezoids at full detail of features of two kinds; features of either kind may be drawn over
/// those of the other.
class CrossOverlaps {
 public:
  enum Kind : std::uint32_t { kept, fresh };

  explicit CrossOverlaps(const LayerContents& layer) : layer_(layer) {}

  void add(std::uint32_t trapezoid, Kind kind) {
    kinds_.emplace(layer_.feature_of[trapezoid], kind);
    trapezoids_.push_back(trapezoid);
  }

  FeatureOverlaps find() const {
    // In order of rows, because the two orders of comparing a pair differ in rounding.
    std::vector<std::uint32_t> rows;
    std::vector<std::uint32_t> kinds;
    std::vector<Box> boxes;
    for (const auto& [row, kind] : kinds_) {
      rows.push_back(row);
      kinds.push_back(kind);
      boxes.push_back(box_of_feature(layer_, row));
    }
    std::vector<MeshTrapezoid> trapezoids;
    std::vector<std::uint32_t> feature_of;
    for (const std::uint32_t i : trapezoids_) {
      trapezoids.push_back(layer_.trapezoids[i]);
      const auto row = std::ranges::lower_bound(rows, layer_.feature_of[i]);
      feature_of.push_back(static_cast<std::uint32_t>(row - rows.begin()));
    }
    const MeshView mesh{0, layer_.vertices, layer_.edges, trapezoids};
    const std::vector<Lifespan> lifespans(trapezoids.size());
    FeatureOverlaps overlaps = find_overlaps({mesh, lifespans, feature_of, kinds, boxes});
    for (FeatureOverlap& pair : overlaps.pairs) {
      pair.row = rows[pair.row];
      pair.other = rows[pair.other];
    }
    return overlaps;
  }

 private:
  const LayerContents& layer_;
  std::map<std::uint32_t, std::uint32_t> kinds_;  // by row
  std::vector<std::uint32_t> trapezoids_;
};

/// The motes as squares, in order for the index.
struct Squares {
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<MeshTrapezoid> trapezoids;
  std::vector<Lifespan> lifespans;
};

Squares squares_of(std::vector<Mote>& motes) {
  std::ranges::stable_sort(motes, {}, [](const Mote& mote) { return order_key(mote); });
  Squares squares;
  for (const Mote& mote : motes) {
    append_mote(mote, squares.vertices, squares.edges, squares.trapezoids);
    squares.lifespans.push_back(mote.lifespan);
  }
  return squares;
}

/// The state of a patch while it is made.
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

  /// Ends the trapezoids and the dust of everything that is replaced, namely the features of
  /// `units`.
  void end_lives(std::span<const Box> units, int most_motes) {
    for (const Box& unit : units) end_trapezoids(unit);
    std::vector<FeatureGrain> gone;
    for (const FeatureGrain& grain : now_.grains().grains()) {
      if (is_replaced_[grain.row] != 0) gone.push_back(grain);
    }
    for (const Grain& grain : uncovered(gone)) {
      const int motes = count_of_motes(grain.axis, pixel_of_level(grain.born), most_motes);
      lay_out(grain.axis, grain.area, motes, [&](double x, double y, double area) {
        end_mote({x, y, area, {grain.born, kNeverDies}});
      });
    }
  }

  std::vector<Mote>& makeup() { return makeup_; }
  /// The lifespans of all trapezoids: the existing ones, up to `end`, and the new ones.
  std::vector<Lifespan> take_lifespans(std::uint32_t end, const LayerContents& from,
                                       const Squares& makeup) {
    lifespans_.resize(end, kNever);
    lifespans_.insert(lifespans_.end(), from.lifespans.begin(), from.lifespans.end());
    lifespans_.insert(lifespans_.end(), makeup.lifespans.begin(), makeup.lifespans.end());
    return std::move(lifespans_);
  }
  FeatureTable take_features() { return std::move(features_); }

  std::vector<FeatureGrain> grains() const {
    std::vector<FeatureGrain> fresh(from_.grains().grains().begin(), from_.grains().grains().end());
    for (FeatureGrain& grain : fresh) grain.row = rows_[grain.row];
    std::vector<FeatureGrain> kept;
    kept.reserve(now_.grains().grains().size() + fresh.size());
    for (const FeatureGrain& grain : now_.grains().grains()) {
      if (is_replaced_[grain.row] == 0) kept.push_back(grain);
    }
    // Both are in order, as in layers.
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

  /// Of all features of the next state, whose segments from `first_fresh` on are new.
  FeatureOverlaps overlaps(const LayerContents& next, std::size_t first_fresh) const {
    FeatureOverlaps all = overlaps_with_kept(next, first_fresh);
    for (const FeatureOverlap& pair : now_.overlaps().pairs()) {
      const bool is_kept = is_replaced_[pair.row] == 0 && is_replaced_[pair.other] == 0;
      if (is_kept) all.pairs.push_back(pair);
    }
    for (FeatureOverlap pair : from_.overlaps().pairs()) {
      pair.row = rows_[pair.row];
      pair.other = rows_[pair.other];
      all.pairs.push_back(pair);
    }
    std::ranges::sort(all.pairs, {},
                      [](const FeatureOverlap& p) { return std::pair(p.row, p.other); });
    return all;
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
  /// Of new features with those that stay.
  FeatureOverlaps overlaps_with_kept(const LayerContents& next, std::size_t first_fresh) const {
    CrossOverlaps search(next);
    std::vector<TrapezoidRange> ranges;
    std::vector<std::uint32_t> near;
    for (std::uint32_t row = 0; row < rows_.size(); ++row) {
      const Box around = box_of_feature(from_.contents(), row);
      if (around.is_empty()) continue;
      const Box box = with_margin(around, kTouch);
      ranges.clear();
      for (std::size_t i = 0; i < first_fresh; ++i) {
        next.segments[i]->polygons.select(box, 0, 0, next.lifespans, ranges);
      }
      for_each_trapezoid(ranges, [&near](std::uint32_t i) { near.push_back(i); });
    }
    leave_one_of_each(near);
    for (const std::uint32_t i : near) search.add(i, CrossOverlaps::kept);
    for (std::size_t k = first_fresh; k < next.segments.size(); ++k) {
      const TrapezoidRange range = next.segments[k]->polygons.range();
      for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
        if (next.lifespans[i].contains(0)) search.add(i, CrossOverlaps::fresh);
      }
    }
    return search.find();
  }

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
    is_replaced_.assign(features_.size(), 0);
    for (const std::int64_t id : patch.ids) {
      const auto row = row_of_id.find(id);
      if (row == row_of_id.end()) continue;
      if (std::exchange(is_replaced_[row->second], 1) == 0) replaced_.push_back(row->second);
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
      if (is_replaced_[now_.feature_of(i)] != 0) lifespans_[i] = kNever;
    });
  }

  /// Ends the mote if it represents only replaced features; otherwise notes a mote that compensates
  /// for it.
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
  std::vector<std::uint32_t> rows_;        // by row of the patch
  std::vector<std::uint32_t> replaced_;    // rows
  std::vector<std::uint8_t> is_replaced_;  // by row
  std::vector<Lifespan> lifespans_;
  std::vector<Mote> makeup_;
  std::vector<TrapezoidRange> ranges_;
};

/// The sizes of the arrays to which a patch refers by number.
struct Ends {
  std::uint32_t vertices = 0;
  std::uint32_t edges = 0;
  std::uint32_t trapezoids = 0;
  std::uint32_t milestones = 0;
  std::uint32_t rings = 0;
};

void append_ends(std::span<const std::uint32_t> ends, std::size_t by,
                 SharedArray<std::uint32_t>& to) {
  std::vector<std::uint32_t> shifted(ends.begin(), ends.end());
  for (std::uint32_t& end : shifted) end += static_cast<std::uint32_t>(by);
  to.append(shifted);
}

}  // namespace

struct LayerPatcher::State {
  std::shared_ptr<const Layer> first;
  std::shared_ptr<const Layer> now;
  std::size_t patches = 0;
  int most_motes = 1;  // of a grain, in the original layer

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

  std::unordered_map<std::int64_t, std::uint32_t> row_of_id;  // including removed features
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

  /// Throws like the constructor of LayerPatcher.
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

  /// `row_of` maps rows of that layer to present rows.
  template <typename RowOf>
  void note_groups(const LayerContents& layer, const RowOf& row_of) {
    const BuiltUnitsView units = layer.units();
    for (std::size_t g = 0; g < units.groups.size(); ++g) {
      std::vector<std::uint32_t>& rows = groups.emplace_back();
      for (const GroupMember& member : units.members_of(g)) {
        rows.push_back(row_of(member.row));
        group_of[rows.back()] = static_cast<std::uint32_t>(groups.size() - 1);
      }
    }
  }

  /// The boxes of the units to which these rows belong. However much it is simplified, each unit
  /// stays within its box; a feature of a group may leave its own.
  std::vector<Box> boxes_of_units(std::span<const std::uint32_t> rows) const {
    std::vector<Box> boxes;
    std::unordered_set<std::uint32_t> done;
    for (const std::uint32_t row : rows) {
      const std::uint32_t group = group_of[row];
      if (group != kNone && !done.insert(group).second) continue;
      Box& box = boxes.emplace_back();
      const std::span<const std::uint32_t> unit =
          group == kNone ? std::span(&row, 1) : std::span<const std::uint32_t>(groups[group]);
      for (const std::uint32_t member : unit) box.include(box_of_feature(now->contents(), member));
    }
    return boxes;
  }

  /// Appends the places of pairs of overlapping features of which only one is among these rows: in
  /// styles that round corners or widen features, the other one may look different everywhere.
  void append_pairs(std::span<const std::uint32_t> rows,
                    std::vector<LayerChanges::Place>& places) const {
    const std::unordered_set<std::uint32_t> among(rows.begin(), rows.end());
    for (const std::uint32_t row : rows) {
      for (const FeatureOverlap& pair : now->overlaps().of(row)) {
        if (among.contains(pair.other)) continue;
        const Box box = box_of_feature(now->contents(), row);
        for (const Box& other : boxes_of_units(std::span(&pair.other, 1))) {
          places.push_back({box, Lifespan(), false, other});
        }
      }
    }
  }

  /// Contents that are views of everything appended so far.
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

  Ends ends() const {
    return {static_cast<std::uint32_t>(vertices.size()), static_cast<std::uint32_t>(edges.size()),
            static_cast<std::uint32_t>(trapezoids.size()),
            static_cast<std::uint32_t>(milestones.size()),
            static_cast<std::uint32_t>(ring_ends.size())};
  }

  void check_room(const LayerContents& from, const Squares& makeup) const {
    require_countable(vertices.size() + from.vertices.size() + makeup.vertices.size(), "vertices");
    require_countable(edges.size() + from.edges.size() + makeup.edges.size(), "versions of edges");
    require_countable(trapezoids.size() + from.trapezoids.size() + makeup.trapezoids.size(),
                      "versions of trapezoids");
    require_countable(milestones.size() + from.milestones.size(), "milestones");
    require_countable(outline_points.size() + from.outline_points.size(), "vertices of rings");
  }

  void append_mesh(const LayerContents& from, const Squares& makeup) {
    append(from.vertices, from.edges, from.trapezoids);
    append(makeup.vertices, makeup.edges, makeup.trapezoids);
  }

  void append(std::span<const Point> points, std::span<const MeshEdge> their_edges,
              std::span<const MeshTrapezoid> their_trapezoids) {
    const Ends by = ends();
    std::vector<MeshEdge> shifted_edges(their_edges.begin(), their_edges.end());
    for (MeshEdge& edge : shifted_edges) {
      edge.upper += by.vertices;
      edge.lower += by.vertices;
    }
    std::vector<MeshTrapezoid> shifted(their_trapezoids.begin(), their_trapezoids.end());
    for (MeshTrapezoid& trapezoid : shifted) {
      trapezoid.top += by.vertices;
      trapezoid.bottom += by.vertices;
      trapezoid.left += by.edges;
      trapezoid.right += by.edges;
    }
    vertices.append(points);
    edges.append(shifted_edges);
    trapezoids.append(shifted);
  }

  // From here on, arrays that end before dust does are padded first.
  void append_features(const LayerContents& from, const Ends& before, const Patching& patching) {
    std::vector<std::uint32_t> rows(from.feature_of.begin(), from.feature_of.end());
    for (std::uint32_t& row : rows) {
      if (row != Layer::kNoFeature) row = patching.row_of(row);
    }
    feature_of.append(before.trapezoids - feature_of.size(), Layer::kNoFeature);
    feature_of.append(rows);
    loop_sizes.append(before.edges - loop_sizes.size(), LoopSize{kLoopSizes - 1});
    loop_sizes.append(from.loop_sizes);
  }

  void append_milestones(const LayerContents& from, const Ends& before) {
    milestone_ends.append(before.vertices - milestone_ends.size(), before.milestones);
    append_ends(from.milestone_ends, before.milestones, milestone_ends);
    milestones.append(from.milestones);
    milestone_levels.append(from.milestone_levels);
  }

  void append_outlines(const LayerContents& from) {
    append_ends(from.ring_ends, outline_points.size(), ring_ends);
    outline_points.append(from.outline_points);
  }

  /// The next state: items appended since `before` exist, and those that they replace do not.
  std::shared_ptr<const Layer> next(const LayerContents& from, const Squares& makeup,
                                    const Ends& before, Patching& patching) const {
    const LayerContents& old = now->contents();
    auto next = new_contents({first});
    next->lifespans = patching.take_lifespans(before.trapezoids, from, makeup);
    next->moved_outlines = old.moved_outlines;
    for (std::uint32_t row = 0; row < from.features.size(); ++row) {
      const RingRange range = from.rings_of(row);
      next->moved_outlines[patching.row_of(row)] = {before.rings + range.begin,
                                                    before.rings + range.end};
    }
    next->outline_ends = StoredArray<std::uint32_t>::looking_at(first->contents().outline_ends);
    next->features = patching.take_features();
    next->is_removed = patching.removed(next->features.size());
    next->grains = GrainIndex(patching.grains());
    next->size = {old.size.vertices + from.size.vertices,
                  old.size.trapezoids + from.size.trapezoids, old.size.edges + from.size.edges,
                  old.size.motes + from.size.motes + makeup.trapezoids.size()};
    next->options = old.options;
    next->bounds = patching.bounds();
    next->segments = old.segments;
    append_segments(from, makeup, before.trapezoids, *next);
    FeatureOverlaps overlaps = patching.overlaps(*next, old.segments.size());
    next->has_all_overlaps = old.has_all_overlaps && from.has_all_overlaps && overlaps.is_complete;
    next->overlaps = OverlapTable(std::move(overlaps.pairs), next->features.size());
    return std::make_shared<const Layer>(std::move(next));
  }

  static void append_segments(const LayerContents& from, const Squares& makeup,
                              std::uint32_t trapezoids, LayerContents& next) {
    const auto index = [&](TrapezoidRange range) {
      return MeshIndex(next.view, {trapezoids + range.first, range.count}, next.lifespans);
    };
    const MeshSegment& segment = from.first_segment();
    next.segments.push_back(std::make_shared<const MeshSegment>(
        MeshSegment{index(segment.polygons.range()), index(segment.horizontal_edges.range()),
                    index(segment.motes.range()), index(segment.merged_motes.range())}));
    if (makeup.trapezoids.empty()) return;
    next.segments.push_back(std::make_shared<const MeshSegment>(
        MeshSegment{{},
                    {},
                    {},
                    index({static_cast<std::uint32_t>(from.trapezoids.size()),
                           static_cast<std::uint32_t>(makeup.trapezoids.size())})}));
  }

  void note_rows(const LayerContents& from, const Patching& patching) {
    for (const std::uint32_t row : patching.replaced()) group_of[row] = kNone;
    group_of.resize(now->features().size(), kNone);
    note_groups(from, [&patching](std::uint32_t row) { return patching.row_of(row); });
    for (std::uint32_t row = 0; row < from.features.size(); ++row) {
      row_of_id.emplace(from.features.id(row), patching.row_of(row));
    }
  }
};

LayerPatcher::LayerPatcher(const Layer& whole) : state_(std::make_unique<State>(whole.contents())) {
  const LayerContents& contents = whole.contents();
  state_->begin_with(contents);
  state_->most_motes =
      most_motes_of(uncovered(contents.grains.grains()), contents.count_vertices());
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
  leave_one_of_each(near);
  for (const std::uint32_t row : near) add_unit(row);
  leave_one_of_each(rows);
  std::vector<std::int64_t> all;
  all.reserve(rows.size() + fresh.size());
  for (const std::uint32_t row : rows) all.push_back(now.features().id(row));
  all.insert(all.end(), fresh.begin(), fresh.end());
  return all;
}

void LayerPatcher::start_over() {
  state_->number_first();
}

LayerChanges LayerPatcher::apply(const Patch& patch) {
  State& state = *state_;
  const LayerContents& from = patch.features.contents();
  Patching patching(*state.now, patch, state.row_of_id);
  std::vector<Box> places = state.boxes_of_units(patching.replaced());
  LayerChanges changes;
  state.append_pairs(patching.replaced(), changes.places);
  patching.end_lives(places, state.most_motes);
  const Squares makeup = squares_of(patching.makeup());
  state.check_room(from, makeup);
  const Ends ends = state.ends();
  state.append_mesh(from, makeup);
  state.append_features(from, ends, patching);
  state.append_milestones(from, ends);
  state.append_outlines(from);
  state.now = state.next(from, makeup, ends, patching);
  state.note_rows(from, patching);
  ++state.patches;
  const std::vector<Box> fresh = state.boxes_of_units(patching.rows());
  places.insert(places.end(), fresh.begin(), fresh.end());
  state.append_pairs(patching.rows(), changes.places);
  for (const Box& place : places) {
    if (!place.is_empty()) changes.places.push_back({place, Lifespan()});
  }
  return changes;
}

}  // namespace trapeze
