#include "core/borders/region_borders.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/borders/border_lengths.h"
#include "core/graph/generalization.h"

namespace trapeze {
namespace {

// Of a square, area over diagonal is its width over the square root of two.
constexpr double kWeightOfMeanWidth = 0.70710678118654752;

}  // namespace

void RegionBorders::assign(const TrapezoidalGraph& graph) {
  graph_ = &graph;
  Regions regions(graph);
  beside_ = std::move(regions.beside);
  area_ = std::move(regions.area);
  unbounded_ = regions.unbounded;
  const std::size_t edges = graph.edges().size();
  parent_.clear();
  for (std::size_t r = 0; r < area_.size(); ++r) parent_.push_back(RegionId(r));
  replaced_by_.clear();
  for (std::size_t e = 0; e < edges; ++e) replaced_by_.push_back(EdgeId(e));
  corner_of_.assign(edges, CornerId());
  seen_.assign(edges, 0);
  stamp_ = 0;
  lists_.assign(area_.size(), List());
  seeds_.clear();
  ends_.clear();
  for (std::size_t i = 0; i < graph.corners().size(); ++i) {
    const Corner& corner = graph.corner(CornerId(i));
    if (!corner.is_alive()) continue;
    if (!corner.edge.is_none()) corner_of_[corner.edge] = CornerId(i);
    if (corner.is_end()) ends_.emplace_back(corner.vertex, CornerId(i));
  }
  std::sort(ends_.begin(), ends_.end());
  // Each arc once, by the first of its edges that is met.
  stamp_ = 1;
  for (std::size_t i = 0; i < edges; ++i) {
    const EdgeId e(i);
    if (corner_of_[e].is_none() || seen_[e] == stamp_) continue;
    edges_.clear();
    walk_arc(e);
    for (const RegionId region : beside_[e]) add_seed(region, e);
  }
}

void RegionBorders::add_seed(RegionId region, EdgeId edge) {
  const auto seed = static_cast<std::uint32_t>(seeds_.size());
  seeds_.push_back({edge, kNobody});
  List& list = lists_[region];
  (list.first == kNobody ? list.first : seeds_[list.last].next) = seed;
  list.last = seed;
}

RegionId RegionBorders::find(RegionId region) {
  while (parent_[region] != region) {
    parent_[region] = parent_[parent_[region]];
    region = parent_[region];
  }
  return region;
}

EdgeId RegionBorders::find(EdgeId edge) {
  while (replaced_by_[edge] != edge) {
    replaced_by_[edge] = replaced_by_[replaced_by_[edge]];
    edge = replaced_by_[edge];
  }
  return edge;
}

void RegionBorders::unite(RegionId a, RegionId b) {
  a = find(a);
  b = find(b);
  if (a == b) return;
  parent_[b] = a;
  area_[a] += area_[b];
  if (b == unbounded_) unbounded_ = a;
  List& list = lists_[a];
  const List more = lists_[b];
  if (more.first == kNobody) return;
  (list.first == kNobody ? list.first : seeds_[list.last].next) = more.first;
  list.last = more.last;
}

void RegionBorders::note_joined(EdgeId gone, EdgeId kept, CornerId corner) {
  replaced_by_[gone] = kept;
  corner_of_[kept] = corner;
}

void RegionBorders::note_lost_loop(EdgeId edge, Side side, Point from, Point to) {
  const Edge& border = graph_->edge(edge);
  const RegionId inside = find(beside_[edge][side]);
  taken_.assign(1, {from, to, area_[inside], border.face[side], border.face[opposite(side)]});
  unite(beside_[edge][opposite(side)], inside);
}

double RegionBorders::weight(RegionId region) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (find(region) != region || region == unbounded_) return kNever;
  collect_arcs(region);
  if (!has_junction_) return kNever;
  const double diagonal = std::hypot(static_cast<double>(box_.max_x) - box_.min_x,
                                     static_cast<double>(box_.max_y) - box_.min_y);
  return kWeightOfMeanWidth * area_[region] / diagonal;
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
    const bool is_new = graph_->edge(e).is_alive() && seen_[e] != stamp_;
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
  arc.first = corner_of_[edge];
  while (!graph_->corner(arc.first).prev.is_none()) {
    arc.first = graph_->corner(arc.first).prev;
    if (arc.first == corner_of_[edge]) break;
  }
  arc.is_closed = !graph_->corner(arc.first).prev.is_none();
  arc.begin = edges_.size();
  CornerId c = arc.first;
  do {
    const Corner& corner = graph_->corner(c);
    box_.include(graph_->point(corner.vertex));
    if (corner.edge.is_none()) break;
    edges_.push_back(corner.edge);
    seen_[corner.edge] = stamp_;
    arc.length += length_of(*graph_, graph_->edge(corner.edge));
    c = corner.next;
  } while (c != arc.first);
  arc.end = edges_.size();
  return arc;
}

Side RegionBorders::side_of(EdgeId edge, RegionId region) {
  return find(beside_[edge][kLeft]) == region ? kLeft : kRight;
}

/// The face with the longest border; the outside only if there is no other, so that a coverage does
/// not fray out along its coasts.
FaceId RegionBorders::choose_taker() const {
  BorderLengths lengths;
  for (const Arc& arc : arcs_) {
    if (arc.beyond != kOutside) lengths.add(arc.beyond, arc.length);
  }
  return lengths.longest();
}

std::vector<RegionId> RegionBorders::remove(RegionId region, EditLog& log) {
  collect_arcs(region);
  const FaceId taker = choose_taker();
  const EdgeId any = edges_.front();
  const FaceId face = graph_->edge(any).face[side_of(any, region)];
  note_taken(face, taker, area_[region]);
  changed_.clear();
  dissolved_.clear();
  std::vector<VertexId> junctions;
  log.begin();
  Generalization generalization(*graph_, log);
  std::vector<RegionId> takers;
  for (const Arc& arc : arcs_) {
    std::vector<CornerId> corners;
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
        takers.push_back(find(beside_[e][opposite(s)]));
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
  for (const RegionId other : takers) unite(region, other);
  std::sort(junctions.begin(), junctions.end());
  junctions.erase(std::unique(junctions.begin(), junctions.end()), junctions.end());
  for (const VertexId v : junctions) repair_junction(v, log);
  return takers;
}

// The area is spread along the whole border, from which the region is nowhere farther away than a
// fraction of a pixel; the border that disappears may be short.
void RegionBorders::note_taken(FaceId face, FaceId taker, double area) {
  taken_.clear();
  double length = 0;
  for (const Arc& arc : arcs_) length += arc.length;
  for (const EdgeId e : edges_) {
    const Edge& edge = graph_->edge(e);
    taken_.push_back({graph_->point(edge.end[kUp]), graph_->point(edge.end[kDown]),
                      area * length_of(*graph_, edge) / length, face, taker});
  }
}

void RegionBorders::repair_junction(VertexId v, EditLog& log) {
  const auto ends =
      std::equal_range(ends_.begin(), ends_.end(), std::pair(v, CornerId()),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
  spokes_.clear();
  for (auto end = ends.first; end != ends.second; ++end) {
    const Corner& corner = graph_->corner(end->second);
    if (!corner.is_end()) continue;
    const EdgeId e = corner.edge.is_none() ? graph_->corner(corner.prev).edge : corner.edge;
    spokes_.push_back(spoke_of(*graph_, v, e, find(beside_[e][kLeft]), find(beside_[e][kRight])));
  }
  sort_around(graph_->point(v), spokes_);
  for (const auto& [a, b] : pair_spokes(spokes_)) join_ends(end_at(v, a), end_at(v, b), log);
}

/// The end, at `v`, of the arc that leads from there by `edge`.
CornerId RegionBorders::end_at(VertexId v, EdgeId edge) const {
  const CornerId c = corner_of_[edge];
  return graph_->corner(c).vertex == v && graph_->corner(c).is_end() ? c : graph_->corner(c).next;
}

/// Makes one corner of the ends of two arcs, or of both ends of one.
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
  corner_of_[begin.edge] = last;
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
    if (!before.is_none()) corner_of_[before] = c;
    before = corner.edge;
    c = corner.next;
  }
}

}  // namespace trapeze
