#include "bench/experiment/topology_keeper.h"

#include <algorithm>
#include <cmath>

#include "core/adapt/farthest_vertex.h"

namespace trapeze::experiment {
namespace {

// Examining so few one by one is faster than putting them into a grid.
constexpr std::size_t kFewVertices = 24;

Point vertex(std::span<const Point> ring, std::uint32_t i) {
  return ring[i < ring.size() ? i : i - ring.size()];
}

bool is_on_segment(Point p, Point a, Point b) {
  return orientation(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) &&
         std::min(a.y, b.y) <= p.y && p.y <= std::max(a.y, b.y);
}

/// Whether the edge meets the ray from p to the right; the upper end of an edge belongs to it.
bool is_right_of(Point p, Point a, Point b) {
  if ((a.y <= p.y) == (b.y <= p.y)) return false;
  const std::int64_t side = orientation(a, b, p);
  return a.y < b.y ? side > 0 : side < 0;
}

/// By the even-odd rule, including the border.
bool is_enclosed(Point p, std::span<const Point> ring, const Chain& chain) {
  Point from = vertex(ring, chain.end);
  bool is_inside = false;
  for (std::uint32_t i = chain.begin; i <= chain.end; ++i) {
    const Point to = vertex(ring, i);
    if (is_on_segment(p, from, to)) return true;
    is_inside ^= is_right_of(p, from, to);
    from = to;
  }
  return is_inside;
}

Box grown_box(Point a, Point b, double by) {
  Box box;
  box.include(a);
  box.include(b);
  const double reach = std::ceil(by) + 1;
  const auto moved = [](std::int32_t v, double d) {
    return static_cast<std::int32_t>(std::clamp(v + d, double{kGridMin}, double{kGridMax}));
  };
  return {moved(box.min_x, -reach), moved(box.min_y, -reach), moved(box.max_x, reach),
          moved(box.max_y, reach)};
}

bool holds(const Box& box, Point p) {
  return box.min_x <= p.x && p.x <= box.max_x && box.min_y <= p.y && p.y <= box.max_y;
}

}  // namespace

void PointGrid::assign(std::span<const Point> points) {
  bounds_ = {};
  for (const Point p : points) bounds_.include(p);
  const std::int64_t width = std::int64_t{bounds_.max_x} - bounds_.min_x + 1;
  const std::int64_t height = std::int64_t{bounds_.max_y} - bounds_.min_y + 1;
  const double area = static_cast<double>(width) * static_cast<double>(height);
  const double share = std::sqrt(2 * area / static_cast<double>(points.size()));
  // A polygon that is almost a line must not have more cells than points.
  const auto longest = static_cast<double>(std::max(width, height));
  side_ = static_cast<std::int64_t>(
      std::ceil(std::max(share, 2 * longest / static_cast<double>(points.size()))));
  columns_ = (width - 1) / side_ + 1;
  rows_ = (height - 1) / side_ + 1;
  begins_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  cell_of_.resize(points.size());
  points_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    cell_of_[i] = static_cast<std::uint32_t>(row(points[i].y) * columns_ + column(points[i].x));
    ++begins_[cell_of_[i] + 1];
  }
  for (std::size_t c = 1; c < begins_.size(); ++c) begins_[c] += begins_[c - 1];
  // Each begin advances to the end of its cell, which is the begin of the next one; then all are
  // shifted.
  for (std::size_t i = 0; i < points.size(); ++i) points_[begins_[cell_of_[i]]++] = points[i];
  std::rotate(begins_.begin(), begins_.end() - 1, begins_.end());
  begins_[0] = 0;
}

std::int64_t PointGrid::column(std::int32_t x) const {
  return (std::int64_t{std::clamp(x, bounds_.min_x, bounds_.max_x)} - bounds_.min_x) / side_;
}

std::int64_t PointGrid::row(std::int32_t y) const {
  return (std::int64_t{std::clamp(y, bounds_.min_y, bounds_.max_y)} - bounds_.min_y) / side_;
}

void TopologyKeeper::keep(const PolygonSet& polygons, std::size_t polygon,
                          RingSimplifier& simplifier, PolygonChains& chains) {
  const auto has_dropped = [](const Chain& chain) { return chain.has_dropped(); };
  if (std::none_of(chains.chains.begin(), chains.chains.end(), has_dropped)) return;
  const std::uint32_t first_ring = polygons.first_ring(polygon);
  collect_kept(polygons, first_ring, chains);
  split_inconsistent(polygons, first_ring, simplifier, all_kept_, chains);
  // Split chains keep vertices that may be in the area enclosed by other chains; only these are new
  // to chains already found consistent.
  while (!newly_kept_.empty()) {
    all_kept_.points.insert(all_kept_.points.end(), newly_kept_.begin(), newly_kept_.end());
    all_kept_.is_indexed = false;
    last_kept_.points.swap(newly_kept_);
    last_kept_.is_indexed = false;
    split_inconsistent(polygons, first_ring, simplifier, last_kept_, chains);
  }
}

void TopologyKeeper::collect_kept(const PolygonSet& polygons, std::uint32_t first_ring,
                                  const PolygonChains& chains) {
  all_kept_.points.clear();
  all_kept_.is_indexed = false;
  for (std::size_t r = 0; r < chains.ends.size(); ++r) {
    if (chains.has_gone(r)) continue;
    const auto ring = polygons.rings[first_ring + r];
    for (std::uint32_t c = chains.first(r); c < chains.ends[r]; ++c) {
      all_kept_.points.push_back(ring[chains.chains[c].begin]);
    }
  }
}

void TopologyKeeper::KeptVertices::index() {
  has_grid = points.size() > kFewVertices;
  if (has_grid) grid.assign(points);
  is_indexed = true;
}

void TopologyKeeper::split_inconsistent(const PolygonSet& polygons, std::uint32_t first_ring,
                                        RingSimplifier& simplifier, KeptVertices& kept,
                                        PolygonChains& chains) {
  newly_kept_.clear();
  next_.clear();
  for (std::uint32_t r = 0; r < chains.ends.size(); ++r) {
    const std::uint32_t ring = first_ring + r;
    const auto points = polygons.rings[ring];
    for (std::uint32_t c = chains.first(r); c < chains.ends[r]; ++c) {
      pending_.emplace_back(chains.chains[c], false);
      while (!pending_.empty()) {
        const auto [chain, is_part] = pending_.back();
        pending_.pop_back();
        // Parts may enclose area that the whole chain did not.
        if (!chain.has_dropped() || is_consistent(points, chain, is_part ? all_kept_ : kept)) {
          next_.chains.push_back(chain);
          continue;
        }
        newly_kept_.push_back(points[chain.split]);
        const auto [before, after] = simplifier.split(ring, chain);
        pending_.emplace_back(after, true);
        pending_.emplace_back(before, true);
        ++splits_;
      }
    }
    next_.ends.push_back(static_cast<std::uint32_t>(next_.chains.size()));
    if (chains.has_gone(r) && !next_.has_gone(r)) {
      newly_kept_.insert(newly_kept_.end(), {points[0], points[polygons.second_anchors[ring]]});
    }
  }
  if (!newly_kept_.empty()) std::swap(chains, next_);
}

// The whole area enclosed by the chain and its chord is at most as far from the chord as the
// farthest vertex.
bool TopologyKeeper::is_consistent(std::span<const Point> ring, const Chain& chain,
                                   KeptVertices& kept) const {
  if (!kept.is_indexed) kept.index();
  const Point a = ring[chain.begin];
  const Point b = vertex(ring, chain.end);
  const Box box = grown_box(a, b, chain.distance);
  const SegmentDistance distance(a, b);
  const double reach = (chain.distance + 1) * (chain.distance + 1);
  const auto is_in_the_way = [&](Point p) {
    return holds(box, p) && distance.squared(p) <= reach && p != a && p != b &&
           is_enclosed(p, ring, chain);
  };
  if (kept.has_grid) return !kept.grid.any_in(box, is_in_the_way);
  return std::none_of(kept.points.begin(), kept.points.end(), is_in_the_way);
}

}  // namespace trapeze::experiment
