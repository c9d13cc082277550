#include "core/sweep/noding.h"

#include <algorithm>
#include <cstdint>

#include "core/sweep/segment_tree.h"

namespace trapeze {
namespace {

/// floor(a / b + 1/2) for b > 0.
Int128 round_half_up(Int128 a, Int128 b) {
  const Int128 n = 2 * a + b;
  const Int128 d = 2 * b;
  Int128 q = n / d;
  if (n % d < 0) --q;
  return q;
}

int sign(std::int64_t v) {
  return (v > 0) - (v < 0);
}

/// Appends where two segments meet, other than at a common end: the rounded crossing of their
/// interiors, or the ends of one that lie on the other.
void add_meetings(const Segment& s, const Segment& t, std::vector<Point>& points) {
  const std::int64_t s1 = orientation(t.first, t.second, s.first);
  const std::int64_t s2 = orientation(t.first, t.second, s.second);
  if (sign(s1) * sign(s2) > 0) return;
  const std::int64_t t1 = orientation(s.first, s.second, t.first);
  const std::int64_t t2 = orientation(s.first, s.second, t.second);
  if (sign(t1) * sign(t2) > 0) return;
  if (sign(s1) * sign(s2) < 0 && sign(t1) * sign(t2) < 0) {
    // Along s the orientation to t goes linearly from s1 to s2: it is 0 at the share s1 / (s1 -
    // s2).
    Int128 num = s1;
    Int128 den = static_cast<Int128>(s1) - s2;
    if (den < 0) {
      num = -num;
      den = -den;
    }
    const auto at = [&](std::int32_t a, std::int32_t b) {
      return static_cast<std::int32_t>(a + round_half_up((static_cast<Int128>(b) - a) * num, den));
    };
    points.push_back({at(s.first.x, s.second.x), at(s.first.y, s.second.y)});
    return;
  }
  const auto add_end = [&points](Point p, std::int64_t side, const Segment& other) {
    if (side != 0 || p == other.first || p == other.second) return;
    if (box_of(other).intersects(Box{p.x, p.y, p.x, p.y})) points.push_back(p);
  };
  add_end(s.first, s1, t);
  add_end(s.second, s2, t);
  add_end(t.first, t1, s);
  add_end(t.second, t2, s);
}

/// The segment meets the cell around `centre`, which owns its upper and left side but not its lower
/// and right one, so that the cells share no point: like the rounding of crossings.
bool passes_cell(const Segment& s, Point centre) {
  // In half cells, so that the corners of the cell are integers; 33 bits need wide products.
  const std::int64_t x = 2 * std::int64_t{centre.x};
  const std::int64_t y = 2 * std::int64_t{centre.y};
  const std::int64_t ax = 2 * std::int64_t{s.first.x};
  const std::int64_t ay = 2 * std::int64_t{s.first.y};
  const std::int64_t bx = 2 * std::int64_t{s.second.x};
  const std::int64_t by = 2 * std::int64_t{s.second.y};
  if (std::max(ax, bx) < x - 1 || std::min(ax, bx) >= x + 1) return false;
  if (std::max(ay, by) < y - 1 || std::min(ay, by) >= y + 1) return false;
  // The open sides are taken to lie a vanishing step further in: where a corner is on the line, the
  // step decides on which side it is.
  bool left = false;
  bool right = false;
  for (const int dx : {-1, 1}) {
    for (const int dy : {-1, 1}) {
      Int128 side = static_cast<Int128>(bx - ax) * (y + dy - ay) -
                    static_cast<Int128>(by - ay) * (x + dx - ax);
      if (side == 0) side = (dx > 0 ? by - ay : 0) - (dy > 0 ? bx - ax : 0);
      left = left || side <= 0;
      right = right || side >= 0;
    }
  }
  return left && right;
}

/// A hot cell that a segment passes through.
struct Pass {
  std::uint32_t segment;
  Point hot;
};

std::vector<Point> hot_cells(const std::vector<Segment>& segments, const SegmentTree& tree,
                             HotCells cells) {
  std::vector<Point> hot;
  // A leaf at a time: its segments are near each other and have the same neighbours.
  for (std::size_t leaf = 0; leaf < tree.leaf_count(); ++leaf) {
    tree.query(tree.leaf_box(leaf), leaf, [&](std::size_t other) {
      for (std::size_t i = SegmentTree::leaf_begin(leaf); i < tree.leaf_end(leaf); ++i) {
        const Box box = box_of(segments[i]);
        if (!box.intersects(tree.leaf_box(other))) continue;
        for (std::size_t k = std::max(i + 1, SegmentTree::leaf_begin(other));
             k < tree.leaf_end(other); ++k) {
          if (box_of(segments[k]).intersects(box)) add_meetings(segments[i], segments[k], hot);
        }
      }
    });
  }
  if (cells == HotCells::crossings_and_vertices) {
    for (const Segment& segment : segments) {
      hot.push_back(segment.first);
      hot.push_back(segment.second);
    }
  }
  std::sort(hot.begin(), hot.end(), is_above);
  hot.erase(std::unique(hot.begin(), hot.end()), hot.end());
  return hot;
}

/// All passes, by segment.
std::vector<Pass> find_passes(const std::vector<Segment>& segments, const SegmentTree& tree,
                              const std::vector<Point>& hot) {
  std::vector<Pass> passes;
  for (const Point p : hot) {
    // A cell reaches half a cell beyond its centre, so a segment that ends a cell away can touch
    // it.
    const Box around{p.x - 1, p.y - 1, p.x + 1, p.y + 1};
    tree.query(around, 0, [&](std::size_t leaf) {
      for (std::size_t i = SegmentTree::leaf_begin(leaf); i < tree.leaf_end(leaf); ++i) {
        if (passes_cell(segments[i], p)) passes.push_back({static_cast<std::uint32_t>(i), p});
      }
    });
  }
  std::stable_sort(passes.begin(), passes.end(),
                   [](const Pass& a, const Pass& b) { return a.segment < b.segment; });
  return passes;
}

void add_piece(Point a, Point b, std::uint32_t source, std::vector<Piece>& pieces) {
  if (a != b) pieces.push_back({is_above(a, b) ? Segment{a, b} : Segment{b, a}, source});
}

/// Appends the pieces of a segment that passes the cells of [begin, end), which are put in order
/// along the segment: by the distance of the centre in its direction.
void add_pieces(const Segment& s, std::uint32_t source, std::vector<Pass>::iterator begin,
                std::vector<Pass>::iterator end, std::vector<Piece>& pieces) {
  const auto along = [&s](const Pass& pass) {
    return static_cast<Int128>(std::int64_t{s.second.x} - s.first.x) *
               (std::int64_t{pass.hot.x} - s.first.x) +
           static_cast<Int128>(std::int64_t{s.second.y} - s.first.y) *
               (std::int64_t{pass.hot.y} - s.first.y);
  };
  std::sort(begin, end, [&](const Pass& a, const Pass& b) { return along(a) < along(b); });
  Point last = s.first;
  for (auto pass = begin; pass != end; ++pass) {
    add_piece(last, pass->hot, source, pieces);
    last = pass->hot;
  }
  add_piece(last, s.second, source, pieces);
}

void cancel_pairs(std::vector<Segment>& pieces) {
  std::sort(pieces.begin(), pieces.end(), [](const Segment& a, const Segment& b) {
    return a.first != b.first ? is_above(a.first, b.first) : is_above(a.second, b.second);
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pieces.size();) {
    std::size_t k = i;
    while (k < pieces.size() && pieces[k] == pieces[i]) ++k;
    if ((k - i) % 2 == 1) pieces[kept++] = pieces[i];
    i = k;
  }
  pieces.resize(kept);
}

}  // namespace

std::vector<Segment> segments_of(const Rings& rings) {
  std::vector<Segment> segments;
  segments.reserve(rings.points.size());
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const auto ring = rings[r];
    for (std::size_t i = 0; i < ring.size(); ++i) {
      segments.emplace_back(ring[i], ring[i + 1 < ring.size() ? i + 1 : 0]);
    }
  }
  return segments;
}

std::vector<Piece> node_pieces(const std::vector<Segment>& segments, HotCells cells) {
  const auto order = order_by_place(segments);
  std::vector<Segment> ordered;
  ordered.reserve(segments.size());
  for (const auto& [place, source] : order) ordered.push_back(segments[source]);
  const SegmentTree tree(ordered);
  std::vector<Pass> passes = find_passes(ordered, tree, hot_cells(ordered, tree, cells));
  std::vector<Piece> pieces;
  pieces.reserve(ordered.size() + passes.size());
  auto pass = passes.begin();
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    const auto begin = pass;
    while (pass != passes.end() && pass->segment == i) ++pass;
    add_pieces(ordered[i], order[i].second, begin, pass, pieces);
  }
  return pieces;
}

std::vector<Segment> node_segments(const std::vector<Segment>& segments, HotCells cells) {
  std::vector<Segment> pieces;
  for (const Piece& piece : node_pieces(segments, cells)) pieces.push_back(piece.segment);
  cancel_pairs(pieces);
  return pieces;
}

}  // namespace trapeze
