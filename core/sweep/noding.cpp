#include "core/sweep/noding.h"

#include <algorithm>
#include <cstdint>

#include "core/sweep/meetings.h"
#include "core/sweep/segment_tree.h"

namespace trapeze {
namespace {

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

/// The points at which a segment may be routed, as a region of the map: cells reach half a cell
/// beyond their centres, so a segment that passes a cell away is looked at as well.
class Reach {
 public:
  explicit Reach(const Segment& s) : from_(s.first), to_(s.second), box_(widened(box_of(s))) {}

  /// Whether it may meet the box; exact but for the cell around it.
  bool intersects(const Box& box) const {
    if (!box_.intersects(box)) return false;
    // The line separates the box from itself if two opposite corners, those farthest across the
    // line, lie on one side.
    const Box wide = widened(box);
    const bool falls = (from_.x < to_.x) == (from_.y < to_.y);
    const Point a{wide.min_x, falls ? wide.max_y : wide.min_y};
    const Point b{wide.max_x, falls ? wide.min_y : wide.max_y};
    const std::int64_t side_a = orientation(from_, to_, a);
    const std::int64_t side_b = orientation(from_, to_, b);
    return !(side_a > 0 && side_b > 0) && !(side_a < 0 && side_b < 0);
  }

 private:
  static Box widened(const Box& box) {
    return {box.min_x - 1, box.min_y - 1, box.max_x + 1, box.max_y + 1};
  }

  Point from_;
  Point to_;
  Box box_;
};

std::optional<std::vector<Point>> hot_cells(const std::vector<Segment>& segments, HotCells cells) {
  std::optional<std::vector<Point>> hot = find_meetings(segments, most_meetings(segments.size()));
  if (hot && cells == HotCells::crossings_and_vertices) {
    for (const Segment& segment : segments) {
      hot->push_back(segment.first);
      hot->push_back(segment.second);
    }
    std::sort(hot->begin(), hot->end(), is_above);
    hot->erase(std::unique(hot->begin(), hot->end()), hot->end());
  }
  return hot;
}

/// Hot cells, in an order and under a tree in which those near each other are found together.
class HotTree {
 public:
  explicit HotTree(const std::vector<Point>& hot) : cells_(in_order(hot)), tree_(cells_) {}

  /// Appends the cells through which the segment passes.
  void append_passed(const Segment& segment, std::vector<Point>& passed) const {
    tree_.query(Reach(segment), [&](std::size_t leaf) {
      for (std::size_t i = SegmentTree::leaf_begin(leaf); i < tree_.leaf_end(leaf); ++i) {
        if (passes_cell(segment, cells_[i].first)) passed.push_back(cells_[i].first);
      }
    });
  }

 private:
  static std::vector<Segment> in_order(const std::vector<Point>& hot) {
    std::vector<Segment> cells;
    cells.reserve(hot.size());
    for (const Point p : hot) cells.emplace_back(p, p);
    std::vector<Segment> ordered;
    ordered.reserve(cells.size());
    for (const auto& [place, i] : order_by_place(cells)) ordered.push_back(cells[i]);
    return ordered;
  }

  std::vector<Segment> cells_;
  SegmentTree tree_;
};

void add_piece(Point a, Point b, std::uint32_t source, std::vector<Piece>& pieces) {
  if (a != b) pieces.push_back({is_above(a, b) ? Segment{a, b} : Segment{b, a}, source});
}

/// Appends the pieces of a segment that passes the cells, which are put in order along the segment:
/// by the distance of the centre in its direction.
void add_pieces(const Segment& s, std::uint32_t source, std::vector<Point>& passed,
                std::vector<Piece>& pieces) {
  const auto along = [&s](Point p) {
    return static_cast<Int128>(std::int64_t{s.second.x} - s.first.x) *
               (std::int64_t{p.x} - s.first.x) +
           static_cast<Int128>(std::int64_t{s.second.y} - s.first.y) *
               (std::int64_t{p.y} - s.first.y);
  };
  std::sort(passed.begin(), passed.end(), [&](Point a, Point b) {
    const Int128 along_a = along(a);
    const Int128 along_b = along(b);
    return along_a != along_b ? along_a < along_b : is_above(a, b);
  });
  Point last = s.first;
  for (const Point p : passed) {
    add_piece(last, p, source, pieces);
    last = p;
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

std::size_t most_meetings(std::size_t segments) {
  // About a second's work, from rings to a mesh, and some gigabytes.
  constexpr std::size_t kLeast = std::size_t{1} << 18;
  constexpr std::size_t kMost = std::size_t{1} << 22;
  return std::clamp(2 * segments, kLeast, kMost);
}

std::optional<std::vector<Piece>> node_pieces(const std::vector<Segment>& segments,
                                              HotCells cells) {
  const std::optional<std::vector<Point>> hot = hot_cells(segments, cells);
  if (!hot) return std::nullopt;
  const HotTree tree(*hot);
  // A crossing is passed by two segments, an end of a segment by itself; rounding adds some.
  constexpr std::size_t kPassesOfEach = 4;
  const std::size_t most_pieces =
      kPassesOfEach * (segments.size() + most_meetings(segments.size()));
  std::vector<Piece> pieces;
  pieces.reserve(segments.size() + 2 * hot->size());
  std::vector<Point> passed;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    passed.clear();
    tree.append_passed(segments[i], passed);
    add_pieces(segments[i], static_cast<std::uint32_t>(i), passed, pieces);
    if (pieces.size() > most_pieces) return std::nullopt;
  }
  return pieces;
}

std::optional<std::vector<Segment>> node_segments(const std::vector<Segment>& segments,
                                                  HotCells cells) {
  const std::optional<std::vector<Piece>> noded = node_pieces(segments, cells);
  if (!noded) return std::nullopt;
  std::vector<Segment> pieces;
  pieces.reserve(noded->size());
  for (const Piece& piece : *noded) pieces.push_back(piece.segment);
  cancel_pairs(pieces);
  return pieces;
}

}  // namespace trapeze
