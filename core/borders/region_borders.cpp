#include "core/borders/region_borders.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/borders/border_lengths.h"
#include "core/graph/fetch_ahead.h"
#include "core/graph/generalization.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {
namespace {

// For a square, area over diagonal is its width over the square root of two.
constexpr double kWeightOfMeanWidth = 0.70710678118654752;

struct TrapezoidAxis {
  Axis axis;
  double area = 0;
};

/// The trapezoid of a node as an axis: the longer of the lines between the middles of opposite
/// sides. None if it has no height.
std::optional<TrapezoidAxis> trapezoid_axis_of(const TrapezoidalGraph& graph, const Node& node) {
  const Point top = graph.point(node.end[kUp]);
  const Point bottom = graph.point(node.end[kDown]);
  if (top.y == bottom.y) return std::nullopt;
  const auto line_of = [&graph](EdgeId e) {
    const Edge& edge = graph.edge(e);
    return EdgeLine(graph.point(edge.end[kUp]), graph.point(edge.end[kDown]));
  };
  const EdgeLine left = line_of(node.edge[kLeft]);
  const EdgeLine right = line_of(node.edge[kRight]);
  const auto middle_at = [&](double y) { return (left.x_at(y) + right.x_at(y)) / 2; };
  const double height = static_cast<double>(bottom.y) - top.y;
  const double y = top.y + height / 2;
  const double width = right.x_at(y) - left.x_at(y);
  const double lean = middle_at(bottom.y) - middle_at(top.y);
  const auto at = [](double px, double py) {
    return Point{static_cast<std::int32_t>(std::lround(px)),
                 static_cast<std::int32_t>(std::lround(py))};
  };
  const bool is_wide = width > std::hypot(lean, height);
  const Axis axis = is_wide ? Axis{at(left.x_at(y), y), at(right.x_at(y), y)}
                            : Axis{at(middle_at(top.y), top.y), at(middle_at(bottom.y), bottom.y)};
  return TrapezoidAxis{axis, width * height};
}

}  // namespace

void RegionBorders::assign(const TrapezoidalGraph& graph, const MergePlan* plan) {
  graph_ = &graph;
  plan_ = plan;
  Regions regions(graph);
  measure_regions(regions);
  unbounded_ = regions.unbounded;
  faces_ = std::move(regions.face);
  const std::size_t edges = graph.edges().size();
  parent_.clear();
  parent_.reserve(moments_.size());
  for (std::size_t r = 0; r < moments_.size(); ++r) parent_.push_back(RegionId(r));
  borders_.clear();
  borders_.reserve(edges);
  for (std::size_t e = 0; e < edges; ++e) {
    borders_.push_back({regions.beside[EdgeId(e)], EdgeId(e), CornerId(), 0});
  }
  stamp_ = 0;
  may_have_junction_.assign(moments_.size(), 0);
  known_sizes_.clear();
  for (std::size_t r = 0; r < moments_.size() && plan_ != nullptr; ++r) {
    known_sizes_.push_back(size_of(RegionId(r)));
  }
  first_end_.assign(graph.vertices().size() + 1, 0);
  for (std::size_t i = 0; i < graph.corners().size(); ++i) {
    const Corner& corner = graph.corner(CornerId(i));
    if (!corner.is_alive()) continue;
    if (!corner.edge.is_none()) borders_[corner.edge].corner = CornerId(i);
    if (corner.is_end()) ++first_end_[VertexId(corner.vertex.value + 1)];
  }
  for (std::size_t v = 1; v < first_end_.size(); ++v) {
    first_end_[VertexId(v)] += first_end_[VertexId(v - 1)];
  }
  ends_.assign(first_end_[VertexId(graph.vertices().size())], CornerId());
  std::vector<std::uint32_t> next_end(first_end_.begin(), first_end_.end());
  for (std::size_t i = 0; i < graph.corners().size(); ++i) {
    const Corner& corner = graph.corner(CornerId(i));
    if (corner.is_alive() && corner.is_end()) ends_[next_end[corner.vertex.value]++] = CornerId(i);
  }
  collect_seeds();
}

/// Records each arc once, by the first of its edges encountered. Arcs of a region are stored
/// together.
void RegionBorders::collect_seeds() {
  std::vector<EdgeId> firsts;
  lists_.assign(moments_.size(), List());
  std::vector<std::uint32_t> next_seed(moments_.size() + 1, 0);
  stamp_ = 1;
  for (std::size_t i = 0; i < borders_.size(); ++i) {
    const EdgeId e(i);
    if (borders_[e].corner.is_none() || borders_[e].seen == stamp_) continue;
    edges_.clear();
    const bool has_ends = !walk_arc(e).is_closed;
    firsts.push_back(e);
    for (const RegionId region : borders_[e].beside) {
      ++next_seed[region.value + 1];
      if (has_ends) may_have_junction_[region] = 1;
    }
  }
  for (std::size_t r = 1; r < next_seed.size(); ++r) next_seed[r] += next_seed[r - 1];
  seeds_.assign(2 * firsts.size(), Seed{});
  for (const EdgeId e : firsts) {
    for (const RegionId region : borders_[e].beside) {
      const std::uint32_t seed = next_seed[region.value]++;
      seeds_[seed].edge = e;
      List& list = lists_[region];
      (list.first == kNobody ? list.first : seeds_[list.last].next) = seed;
      list.last = seed;
    }
  }
}

void RegionBorders::measure_regions(const Regions& regions) {
  Table<RegionId, BoundaryMoments> sums;
  sums.assign(regions.area.size(), BoundaryMoments());
  std::vector<bool> has_begun(regions.area.size(), false);
  for (std::size_t i = 0; i < graph_->edges().size(); ++i) {
    const EdgeId e(i);
    const Edge& edge = graph_->edge(e);
    if (!edge.is_alive() || graph_->is_frame(e)) continue;
    const Point upper = graph_->point(edge.end[kUp]);
    const Point lower = graph_->point(edge.end[kDown]);
    for (const Side s : {kLeft, kRight}) {
      const RegionId region = regions.beside[e][s];
      if (!has_begun[region.value]) sums[region] = BoundaryMoments(upper);
      has_begun[region.value] = true;
      sums[region].add(s == kLeft ? upper : lower, s == kLeft ? lower : upper);
    }
  }
  moments_.clear();
  for (std::size_t r = 0; r < sums.size(); ++r) {
    moments_.push_back(sums[RegionId(r)].sum());
    moments_[RegionId(r)].area = regions.area[RegionId(r)];
  }
}

RegionId RegionBorders::find(RegionId region) {
  while (parent_[region] != region) {
    parent_[region] = parent_[parent_[region]];
    region = parent_[region];
  }
  return region;
}

EdgeId RegionBorders::find(EdgeId edge) {
  for (;;) {
    EdgeId& next = borders_[edge].replaced_by;
    if (next == edge) return edge;
    next = borders_[next].replaced_by;
    edge = next;
  }
}

void RegionBorders::unite(RegionId a, RegionId b) {
  a = find(a);
  b = find(b);
  if (a == b) return;
  parent_[b] = a;
  moments_[a].unite(moments_[b]);
  may_have_junction_[a] |= may_have_junction_[b];
  if (b == unbounded_) unbounded_ = a;
  List& list = lists_[a];
  const List more = lists_[b];
  if (more.first == kNobody) return;
  (list.first == kNobody ? list.first : seeds_[list.last].next) = more.first;
  list.last = more.last;
}

void RegionBorders::note_joined(EdgeId gone, EdgeId kept, CornerId corner) {
  borders_[gone].replaced_by = kept;
  borders_[kept].corner = corner;
}

void RegionBorders::note_lost_loop(const LostLoop& loop) {
  const Border& border = borders_[loop.edge];
  const RegionId inside = find(border.beside[loop.side]);
  const AreaMoments& lost = moments_[inside];
  taken_.assign(1, {lost.axis(), lost.area, loop.inside, loop.outside});
  unite(border.beside[opposite(loop.side)], inside);
}

double RegionBorders::weight(RegionId region) {
  constexpr double kStays = std::numeric_limits<double>::infinity();
  const bool may_go = plan_ != nullptr || may_have_junction_[region] != 0;
  if (find(region) != region || region == unbounded_ || !may_go) return kStays;
  const FaceId face = faces_[region];
  if (plan_ != nullptr && plan_->is_piece(face)) return plan_->due_of(face);
  collect_arcs(region);
  if (!has_junction_) return kStays;
  const double diagonal = std::hypot(static_cast<double>(box_.max_x) - box_.min_x,
                                     static_cast<double>(box_.max_y) - box_.min_y);
  const double weight = kWeightOfMeanWidth * moments_[region].area / diagonal;
  // A square is removed when its width is twice the tolerance.
  const bool has_mates = plan_ != nullptr && !mates_of(region, face).empty();
  return has_mates ? std::min(weight, weight / (4 * plan_->ratio)) : weight;
}

void RegionBorders::collect_arcs(RegionId region) {
  ++stamp_;
  arcs_.clear();
  edges_.clear();
  box_ = Box();
  has_junction_ = false;
  // Seeds of arcs that no longer exist are dropped on the way.
  List& list = lists_[region];
  std::uint32_t before = kNobody;
  for (std::uint32_t i = list.first; i != kNobody; i = seeds_[i].next) {
    const EdgeId e = find(seeds_[i].edge);
    const bool is_new = graph_->edge(e).is_alive() && borders_[e].seen != stamp_;
    if (!is_new) continue;
    (before == kNobody ? list.first : seeds_[before].next) = i;
    before = i;
    const Arc arc = walk_arc(e);
    has_junction_ = has_junction_ || !arc.is_closed;
    arcs_.push_back(arc);
    arcs_.back().beyond = graph_->edge(e).face[opposite(side_of(e, region))];
  }
  list.last = before;
  if (before == kNobody) {
    list.first = kNobody;
  } else {
    seeds_[before].next = kNobody;
  }
}

RegionBorders::Arc RegionBorders::walk_arc(EdgeId edge) {
  Arc arc;
  arc.first = borders_[edge].corner;
  while (!graph_->corner(arc.first).prev.is_none()) {
    arc.first = graph_->corner(arc.first).prev;
    if (arc.first == borders_[edge].corner) break;
  }
  arc.is_closed = !graph_->corner(arc.first).prev.is_none();
  arc.begin = edges_.size();
  CornerId c = arc.first;
  do {
    const Corner& corner = graph_->corner(c);
    box_.include(graph_->point(corner.vertex));
    if (corner.edge.is_none()) break;
    edges_.push_back(corner.edge);
    borders_[corner.edge].seen = stamp_;
    c = corner.next;
  } while (c != arc.first);
  arc.end = edges_.size();
  return arc;
}

Side RegionBorders::side_of(EdgeId edge, RegionId region) {
  return find(borders_[edge].beside[kLeft]) == region ? kLeft : kRight;
}

/// The face with the longest border; the void only if there is no other, so that a coverage does
/// not fray along its coasts. A region that is already void becomes a part of a piece if possible.
FaceId RegionBorders::choose_taker(FaceId face) const {
  BorderLengths covered;
  BorderLengths pieces;
  bool is_open = false;
  for (const Arc& arc : arcs_) {
    if (arc.beyond == kOutside) {
      is_open = true;
    } else if (plan_ != nullptr && plan_->is_void(arc.beyond)) {
      pieces.add(arc.beyond, length_of_arc(arc));
    } else {
      covered.add(arc.beyond, length_of_arc(arc));
    }
  }
  const bool has_void = is_open || pieces.faces() > 0;
  const bool stays_void = has_void && plan_ != nullptr && plan_->is_void(face);
  if (covered.faces() > 0 && !stays_void) return covered.longest();
  return is_open ? kOutside : pieces.longest();
}

/// For a piece of the void that bridges nothing by itself: an adjacent piece that is filled at the
/// same time or later; the earliest of these. kOutside if there is none.
FaceId RegionBorders::find_later_piece(FaceId face) const {
  FaceId later = kOutside;
  for (const Arc& arc : arcs_) {
    if (arc.beyond == face || !plan_->is_piece(arc.beyond)) continue;
    const double due = plan_->due_of(arc.beyond);
    if (due < plan_->due_of(face)) continue;
    const bool is_first =
        later == kOutside || std::pair(due, arc.beyond) < std::pair(plan_->due_of(later), later);
    if (is_first) later = arc.beyond;
  }
  return later;
}

double RegionBorders::length_of_arc(const Arc& arc) const {
  double length = 0;
  for (std::size_t i = arc.begin; i < arc.end; ++i) {
    length += length_of(*graph_, graph_->edge(edges_[i]));
  }
  return length;
}

/// The mates of the current region, in order of the arcs.
std::vector<RegionBorders::Mate> RegionBorders::mates_of(RegionId region, FaceId face) {
  std::vector<Mate> mates;
  for (const Arc& arc : arcs_) {
    const bool is_void = plan_->is_void(arc.beyond) || face == kOutside;
    if (is_void || !plan_->are_of_one_class(face, arc.beyond)) continue;
    const EdgeId any = edges_[arc.begin];
    const RegionId beyond = find(borders_[any].beside[opposite(side_of(any, region))]);
    auto known = std::ranges::find(mates, beyond, &Mate::region);
    if (known == mates.end()) known = mates.insert(known, Mate{beyond, arc.beyond});
    known->border += length_of_arc(arc);
  }
  return mates;
}

/// Whether a piece of the void, which is the current region, still lies between two regions. With
/// only one neighbour it is a notch, unless it is a spike that once led to another region.
bool RegionBorders::bridges(std::size_t mates) const {
  if (mates != 1) return mates > 1;
  double covered = 0;
  double open = 0;
  for (const Arc& arc : arcs_) {
    (plan_->is_void(arc.beyond) ? open : covered) += length_of_arc(arc);
  }
  return covered >= open;
}

bool RegionBorders::is_smaller(RegionId a, RegionId b) const {
  if (moments_[a].area != moments_[b].area) return moments_[a].area < moments_[b].area;
  return a > b;
}

RegionBorders::United RegionBorders::remove(RegionId region, EditLog& log) {
  collect_arcs(region);
  const FaceId face = faces_[region];
  std::vector<Mate> mates;
  if (plan_ != nullptr) mates = mates_of(region, face);
  const bool is_piece = plan_ != nullptr && plan_->is_piece(face);
  const FaceId taker = choose_taker(face);
  if (is_piece && mates.empty() && !plan_->is_void(taker)) return {};
  taken_.clear();
  changed_.clear();
  dissolved_.clear();
  block_size_.reset();
  block_edges_.clear();
  log.begin();
  United united = {region};
  if (is_piece && bridges(mates.size())) {
    const auto largest = std::ranges::max_element(
        mates, [this](const Mate& a, const Mate& b) { return is_smaller(a.region, b.region); });
    const FaceId block = largest->face;
    dissolve(region, block, log, united);
    for (const Mate& mate : mates) join(united.front(), block, mate, log, united);
  } else if (!is_piece && !mates.empty()) {
    const auto nearest = std::ranges::max_element(mates, {}, &Mate::border);
    join(region, face, *nearest, log, united);
  } else {
    const FaceId later = is_piece ? find_later_piece(face) : kOutside;
    note_taken(region, face, later != kOutside ? later : taker);
    dissolve(region, later != kOutside ? later : taker, log, united);
    return united;
  }
  note_block(united.front());
  return united;
}

/// The area of the unbounded region is negative.
LoopSize RegionBorders::size_of(RegionId region) const {
  return loop_size_of(std::max(moments_[region].area, 0.0));
}

/// A block that grows is walked around only now and then: when its extent has grown by a quarter.
void RegionBorders::note_block(RegionId block) {
  constexpr int kSteps = 3;
  block_size_ = size_of(block);
  if (known_sizes_[block] + kSteps > *block_size_) return;
  known_sizes_[block] = *block_size_;
  collect_arcs(block);
  block_edges_ = edges_;
}

/// Unites two adjacent regions, giving both the face of the larger one.
void RegionBorders::join(RegionId region, FaceId face, const Mate& mate, EditLog& log,
                         United& united) {
  const RegionId other = find(mate.region);
  if (other == region) return;
  const bool other_goes = is_smaller(other, region);
  const RegionId gone = other_goes ? other : region;
  collect_arcs(gone);
  dissolve(gone, other_goes ? face : mate.face, log, united);
}

/// Makes the current region a part of the adjacent regions that have the face of the taker.
void RegionBorders::dissolve(RegionId region, FaceId taker, EditLog& log, United& united) {
  std::vector<VertexId>& junctions = junctions_;
  junctions.clear();
  Generalization generalization(*graph_, log);
  std::vector<RegionId> takers;
  for (const Arc& arc : arcs_) {
    std::vector<CornerId>& corners = gone_corners_;
    corners.clear();
    for (CornerId c = arc.first; !c.is_none(); c = graph_->corner(c).next) {
      corners.push_back(c);
      changed_.push_back(graph_->corner(c).vertex);
      if (graph_->corner(c).is_end()) junctions.push_back(graph_->corner(c).vertex);
      if (arc.is_closed && graph_->corner(c).next == arc.first) break;
    }
    for (std::size_t i = arc.begin; i < arc.end; ++i) {
      const EdgeId e = edges_[i];
      const Side s = side_of(e, region);
      if (arc.beyond == taker) {
        takers.push_back(find(borders_[e].beside[opposite(s)]));
        generalization.remove_edge(e);
      } else {
        log.edit(e).face[s] = taker;
      }
    }
    if (arc.beyond != taker) continue;
    for (const CornerId c : corners) log.edit(c) = Corner{graph_->corner(c).vertex, {}, {}, {}};
  }
  std::sort(takers.begin(), takers.end());
  takers.erase(std::unique(takers.begin(), takers.end()), takers.end());
  if (plan_ != nullptr && !takers.empty()) {
    // The edges of this region, whose face has changed, are told the size of a block.
    const auto known = [this](RegionId other) { return known_sizes_[other]; };
    known_sizes_[region] = known(std::ranges::min(takers, {}, known));
  }
  for (const RegionId other : takers) unite(region, other);
  faces_[region] = taker;
  std::sort(junctions.begin(), junctions.end());
  junctions.erase(std::unique(junctions.begin(), junctions.end()), junctions.end());
  fetch_ends(junctions);
  for (const VertexId v : junctions) repair_junction(v, log);
  united.insert(united.end(), takers.begin(), takers.end());
  std::erase(united, region);
  united.insert(united.begin(), region);
}

void RegionBorders::note_taken(RegionId region, FaceId face, FaceId taker) {
  const AreaMoments& lost = moments_[region];
  if (lost.is_compact()) {
    taken_.push_back({lost.axis(), lost.area, face, taker});
  } else {
    note_pieces(region, face, taker);
  }
}

/// For a winding region: each trapezoid gets its share of the area.
void RegionBorders::note_pieces(RegionId region, FaceId face, FaceId taker) {
  double sum = 0;
  for (const EdgeId e : edges_) {
    // The edges that are left sides of its trapezoids.
    if (side_of(e, region) != kRight) continue;
    for (NodeId n = graph_->edge(e).extreme[kRight][kUp]; !n.is_none();
         n = graph_->node(n).link[kLeft][kDown]) {
      const std::optional<TrapezoidAxis> piece = trapezoid_axis_of(*graph_, graph_->node(n));
      if (!piece) continue;
      sum += piece->area;
      taken_.push_back({piece->axis, piece->area, face, taker});
    }
  }
  for (Taken& taken : taken_) taken.area *= moments_[region].area / sum;
}

std::span<const CornerId> RegionBorders::ends_at(VertexId v) const {
  return std::span(ends_).subspan(first_end_[v], first_end_[VertexId(v.value + 1)] - first_end_[v]);
}

/// Prefetches everything repair_junction() reads for all junctions, each step for all before the
/// next one.
void RegionBorders::fetch_ends(std::span<const VertexId> junctions) const {
  for (const VertexId v : junctions) trapeze::fetch(first_end_, v);
  for (const VertexId v : junctions) __builtin_prefetch(ends_at(v).data());
  for (const VertexId v : junctions) {
    for (const CornerId end : ends_at(v)) trapeze::fetch(graph_->corners(), end);
  }
  for (const VertexId v : junctions) {
    for (const CornerId end : ends_at(v)) {
      const Corner& corner = graph_->corner(end);
      if (!corner.is_end()) continue;
      trapeze::fetch(borders_, corner.edge);
      trapeze::fetch(graph_->edges(), corner.edge);
      trapeze::fetch(graph_->corners(), corner.prev);
    }
  }
}

void RegionBorders::fetch(FetchStep step, RegionId region) const {
  if (step == FetchStep::region) {
    trapeze::fetch(parent_, region);
    trapeze::fetch(faces_, region);
    trapeze::fetch(lists_, region);
    trapeze::fetch(moments_, region);
    return;
  }
  if (parent_[region] != region) return;
  const List& list = lists_[region];
  if (step == FetchStep::seeds) {
    if (list.first != kNobody) __builtin_prefetch(&seeds_[list.first]);
    return;
  }
  // For a large region, enough to start with.
  constexpr int kMostSeeds = 8;
  std::uint32_t i = list.first;
  for (int count = 0; i != kNobody && count < kMostSeeds; i = seeds_[i].next, ++count) {
    const EdgeId e = seeds_[i].edge;
    if (step == FetchStep::edges) {
      trapeze::fetch(borders_, e);
      trapeze::fetch(graph_->edges(), e);
      continue;
    }
    const Edge& edge = graph_->edge(e);
    if (!edge.is_alive()) continue;
    trapeze::fetch(graph_->corners(), borders_[e].corner);
    for (const VertexId v : edge.end) {
      trapeze::fetch(graph_->vertices(), v);
      trapeze::fetch(first_end_, v);
    }
    for (const auto& along : edge.extreme) {
      for (const NodeId n : along) trapeze::fetch(graph_->nodes(), n);
    }
  }
}

void RegionBorders::repair_junction(VertexId v, EditLog& log) {
  spokes_.clear();
  for (const CornerId end : ends_at(v)) {
    const Corner& corner = graph_->corner(end);
    if (!corner.is_end()) continue;
    const EdgeId e = corner.edge.is_none() ? graph_->corner(corner.prev).edge : corner.edge;
    spokes_.push_back(
        spoke_of(*graph_, v, e, find(borders_[e].beside[kLeft]), find(borders_[e].beside[kRight])));
  }
  sort_around(graph_->point(v), spokes_);
  for (const auto& [a, b] : pair_spokes(spokes_)) join_ends(end_at(v, a), end_at(v, b), log);
}

/// The end, at `v`, of the arc that leaves there along `edge`.
CornerId RegionBorders::end_at(VertexId v, EdgeId edge) const {
  const CornerId c = borders_[edge].corner;
  return graph_->corner(c).vertex == v && graph_->corner(c).is_end() ? c : graph_->corner(c).next;
}

/// Makes one corner from the ends of two arcs, or from both ends of one.
void RegionBorders::join_ends(CornerId a, CornerId b, EditLog& log) {
  const auto is_last = [this](CornerId c) { return graph_->corner(c).next.is_none(); };
  if (is_last(a) == is_last(b)) {
    // Both arcs lead here, or both lead away: the one with fewer corners is reversed.
    const Direction on = is_last(a) ? kUp : kDown;
    const auto step = [&](CornerId c) {
      return on == kUp ? graph_->corner(c).prev : graph_->corner(c).next;
    };
    CornerId p = a;
    CornerId q = b;
    while (!p.is_none() && !q.is_none()) {
      p = step(p);
      q = step(q);
    }
    reverse(p.is_none() ? a : b, log);
  }
  const CornerId last = is_last(a) ? a : b;
  const CornerId first = is_last(a) ? b : a;
  const Corner begin = graph_->corner(first);
  log.edit(last).edge = begin.edge;
  log.edit(last).next = begin.next;
  log.edit(begin.next).prev = last;
  log.edit(first) = Corner{begin.vertex, {}, {}, {}};
  borders_[begin.edge].corner = last;
  dissolved_.push_back(last);
}

/// Reverses the arc with this end.
void RegionBorders::reverse(CornerId end, EditLog& log) {
  CornerId c = end;
  while (!graph_->corner(c).prev.is_none()) c = graph_->corner(c).prev;
  EdgeId before;
  while (!c.is_none()) {
    const Corner corner = graph_->corner(c);
    Corner& turned = log.edit(c);
    turned.prev = corner.next;
    turned.next = corner.prev;
    turned.edge = before;
    if (!before.is_none()) borders_[before].corner = c;
    before = corner.edge;
    c = corner.next;
  }
}

}  // namespace trapeze
