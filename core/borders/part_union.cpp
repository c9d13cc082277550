#include "core/borders/part_union.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "core/borders/coverage_builder.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/sweep/clean_rings.h"
#include "core/sweep/graph_builder.h"
#include "core/sweep/segment_tree.h"

namespace trapeze {
namespace {

/// Successive segments of a ring, near each other.
struct Chain {
  Box box;
  std::size_t begin;  // index of a segment
  std::size_t end;
};

/// The segments of a feature, each with its part.
struct PartSegments {
  std::vector<Segment> segments;
  std::vector<std::uint32_t> part_of;
  std::vector<std::size_t> ring_begins;  // indices of segments
  std::vector<Chain> chains;

  PartSegments(const Rings& rings, std::span<const std::uint32_t> part_ends) {
    segments.reserve(rings.points.size());
    part_of.reserve(rings.points.size());
    std::uint32_t part = 0;
    for (std::size_t r = 0; r < rings.size(); ++r) {
      while (r >= part_ends[part]) ++part;
      add_ring(rings[r], part);
    }
  }

 private:
  static constexpr std::size_t kChain = 32;

  void add_ring(std::span<const Point> ring, std::uint32_t part) {
    if (!ring.empty()) ring_begins.push_back(segments.size());
    for (std::size_t i = 0; i < ring.size(); ++i) {
      if (i % kChain == 0) chains.push_back({Box(), segments.size(), segments.size()});
      segments.emplace_back(ring[i], ring[i + 1 < ring.size() ? i + 1 : 0]);
      part_of.push_back(part);
      chains.back().box.include(box_of(segments.back()));
      chains.back().end = segments.size();
    }
  }
};

/// Counts steps, so that the search for an overlap never takes longer than uniting.
class Steps {
 public:
  explicit Steps(std::size_t segments) : left_(1024 + 64 * segments) {}

  void step() { left_ -= left_ > 0 ? 1 : 0; }
  bool are_spent() const { return left_ == 0; }

 private:
  std::size_t left_;
};

/// Whether they have a point in common, even if it is an end of both.
bool do_meet(const Segment& s, const Segment& t) {
  if (!box_of(s).intersects(box_of(t))) return false;
  const auto lie_on_one_side = [](const Segment& line, const Segment& ends) {
    const std::int64_t a = orientation(line.first, line.second, ends.first);
    const std::int64_t b = orientation(line.first, line.second, ends.second);
    return (a > 0 && b > 0) || (a < 0 && b < 0);
  };
  return !lie_on_one_side(s, t) && !lie_on_one_side(t, s);
}

/// Whether boundaries of different parts meet; also true if that is not known in time.
bool do_parts_meet(const PartSegments& parts, Steps& steps) {
  // The tree indexes boxes of segments: each chain is represented by the diagonal of its box.
  std::vector<Segment> diagonals;
  diagonals.reserve(parts.chains.size());
  for (const Chain& chain : parts.chains) {
    diagonals.emplace_back(Point{chain.box.min_x, chain.box.min_y},
                           Point{chain.box.max_x, chain.box.max_y});
  }
  const SegmentTree tree(diagonals);
  bool do_any = false;
  const auto compare = [&](const Chain& a, const Chain& b) {
    for (std::size_t i = a.begin; i < a.end && !do_any; ++i) {
      if (!box_of(parts.segments[i]).intersects(b.box)) continue;
      for (std::size_t k = b.begin; k < b.end && !do_any; ++k) {
        steps.step();
        do_any = steps.are_spent() || do_meet(parts.segments[i], parts.segments[k]);
      }
    }
  };
  for (std::size_t i = 0; i < parts.chains.size() && !do_any; ++i) {
    const Chain& chain = parts.chains[i];
    tree.query(chain.box, [&](std::size_t leaf) {
      for (std::size_t k = SegmentTree::leaf_begin(leaf); k < tree.leaf_end(leaf); ++k) {
        const Chain& other = parts.chains[k];
        if (k >= i || do_any || parts.part_of[chain.begin] == parts.part_of[other.begin]) continue;
        if (chain.box.intersects(other.box)) compare(chain, other);
      }
    });
  }
  return do_any;
}

/// Whether parts whose boundaries do not meet lie within others, even in part: one point of each
/// ring decides. Rings of a part may be anywhere, even outside its first one. Where parts overlap,
/// some ring lies within exactly one other part.
bool do_parts_contain_others(const PartSegments& parts, Steps& steps) {
  struct Probe {
    Point point;
    std::uint32_t part;
    bool is_within = false;  // an odd number of segments of other parts is left of it
  };
  std::vector<Probe> probes;
  for (const std::size_t begin : parts.ring_begins) {
    probes.push_back({parts.segments[begin].first, parts.part_of[begin]});
  }
  std::sort(probes.begin(), probes.end(),
            [](const Probe& a, const Probe& b) { return is_above(a.point, b.point); });
  for (std::size_t i = 0; i < parts.segments.size(); ++i) {
    auto [upper, lower] = parts.segments[i];
    if (upper.y == lower.y) continue;
    if (upper.y > lower.y) std::swap(upper, lower);
    auto probe = std::partition_point(probes.begin(), probes.end(),
                                      [y = upper.y](const Probe& p) { return p.point.y < y; });
    for (; probe != probes.end() && probe->point.y < lower.y; ++probe) {
      steps.step();
      if (steps.are_spent()) return true;
      if (probe->part == parts.part_of[i]) continue;
      // Going down, negative orientation is to the right.
      if (orientation(upper, lower, probe->point) < 0) probe->is_within = !probe->is_within;
    }
  }
  return std::any_of(probes.begin(), probes.end(), [](const Probe& p) { return p.is_within; });
}

bool do_boxes_meet(const Rings& rings, std::span<const std::uint32_t> part_ends) {
  constexpr std::size_t kFewParts = 16;
  if (part_ends.size() > kFewParts) return true;  // not worth examining the pairs
  std::vector<Box> boxes;
  std::size_t ring = 0;
  for (const std::uint32_t end : part_ends) {
    Box box;
    for (; ring < end; ++ring) {
      for (const Point p : rings[ring]) box.include(p);
    }
    for (const Box& other : boxes) {
      if (other.intersects(box)) return true;
    }
    boxes.push_back(box);
  }
  return false;
}

bool may_overlap(const Rings& rings, std::span<const std::uint32_t> part_ends) {
  if (part_ends.size() < 2 || !do_boxes_meet(rings, part_ends)) return false;
  const PartSegments parts(rings, part_ends);
  Steps steps(parts.segments.size());
  return do_parts_meet(parts, steps) || do_parts_contain_others(parts, steps);
}

/// Appends the same points wherever the ring began and in whichever direction it ran.
void append_normalized(std::span<const Point> ring, Rings& out) {
  std::vector<Point> points(ring.begin(), ring.end());
  std::rotate(points.begin(), std::min_element(points.begin(), points.end(), is_above),
              points.end());
  if (is_above(points.back(), points[1])) std::reverse(points.begin() + 1, points.end());
  out.add(points);
}

bool rings_precede(const Rings& a, const Rings& b) {
  if (a.ends != b.ends) return a.ends < b.ends;
  return std::lexicographical_compare(a.points.begin(), a.points.end(), b.points.begin(),
                                      b.points.end(), is_above);
}

/// The parts that have an area, cleaned.
std::vector<Rings> split(const Rings& rings, std::span<const std::uint32_t> part_ends) {
  std::vector<Rings> parts;
  std::size_t ring = 0;
  for (const std::uint32_t end : part_ends) {
    Rings part;
    for (; ring < end; ++ring) part.add(rings[ring]);
    clean_rings(part);
    if (part.empty()) continue;
    Rings& normalized = parts.emplace_back();
    for (std::size_t r = 0; r < part.size(); ++r) append_normalized(part[r], normalized);
  }
  return parts;
}

}  // namespace

PartUnion unite_parts(Rings& rings, std::span<const std::uint32_t> part_ends) {
  PartUnion result;
  if (!may_overlap(rings, part_ends)) return result;
  std::vector<Rings> parts = split(rings, part_ends);
  const std::size_t all = parts.size();
  std::sort(parts.begin(), parts.end(), rings_precede);
  parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
  result.did_overlap = parts.size() < all;
  if (parts.size() == 1 && result.did_overlap) rings = std::move(parts.front());
  if (parts.size() < 2) return result;
  std::vector<const Rings*> pointers;
  pointers.reserve(parts.size());
  for (const Rings& part : parts) pointers.push_back(&part);
  Overlay found = overlay(pointers);
  result.did_overlap = result.did_overlap || !found.overlaps.empty();
  result.failure = std::move(found.failure);
  if (!result.did_overlap) return result;

  // As faces of a coverage they are disjoint, so even-odd yields their union.
  TrapezoidalGraph graph;
  const CoverageOutcome outcome =
      CoverageBuilder().build(pointers, {std::numeric_limits<double>::infinity(), 0}, graph);
  result.failure = outcome.failure;
  if (!outcome.built) return result;
  Rings faces;
  for (const Rings& face : rings_of_faces(graph)) {
    for (std::size_t r = 0; r < face.size(); ++r) faces.add(face[r]);
  }
  const BuildOutcome united = GraphBuilder().build(faces, graph);
  result.failure = united.failure;
  if (united.built) rings = rings_of(graph);
  return result;
}

}  // namespace trapeze
