#include "core/sweep/noding.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/sweep/meetings.h"
#include "core/sweep/segment_tree.h"

namespace trapeze {
namespace {

/// Whether the segment meets the cell around `centre`. A cell includes its upper and left side but
/// not its lower and right one, so cells share no point; this matches the rounding of crossings.
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
  // The open sides are treated as lying infinitesimally further in: where a corner is on the line,
  // that step decides its side.
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

/// The region of points at which a segment may be routed. Cells extend half a cell beyond their
/// centres, so a margin of one cell around the segment is included.
class Reach {
 public:
  explicit Reach(const Segment& s) : from_(s.first), to_(s.second), box_(widened(box_of(s))) {}

  /// Whether the region may meet the box; exact except for the margin of one cell.
  bool intersects(const Box& box) const {
    if (!box_.intersects(box)) return false;
    // The line does not meet the box if two opposite corners, those farthest across the line, lie
    // on one side of it.
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

std::optional<std::vector<Point>> hot_cells(const Boundary& boundary, HotCells cells,
                                            unsigned threads) {
  std::optional<std::vector<Point>> hot =
      find_meetings(boundary, most_meetings(boundary.edges.size()), threads);
  if (hot && cells == HotCells::crossings_and_vertices) {
    hot->insert(hot->end(), boundary.vertices.begin() + 1, boundary.vertices.end() - 1);
    std::sort(hot->begin(), hot->end(), is_above);
    hot->erase(std::unique(hot->begin(), hot->end()), hot->end());
  }
  return hot;
}

/// Quickly rules out most segments that have no hot cell near them: hot cells are few compared with
/// segments.
class HotBlocks {
 public:
  HotBlocks(const std::vector<Point>& hot, const std::vector<Segment>& segments)
      : shift_(shift_for(segments)), is_hot_(kBits, false) {
    for (const Point p : hot) is_hot_[bit_of(p.x >> shift_, p.y >> shift_)] = true;
  }

  bool may_pass_one(const Segment& segment) const {
    // Cells extend half a cell beyond their centres.
    const Box box = box_of(segment);
    const std::int32_t x0 = (box.min_x - 1) >> shift_;
    const std::int32_t x1 = (box.max_x + 1) >> shift_;
    const std::int32_t y0 = (box.min_y - 1) >> shift_;
    const std::int32_t y1 = (box.max_y + 1) >> shift_;
    if ((std::int64_t{x1} - x0 + 1) * (std::int64_t{y1} - y0 + 1) > kMostBlocks) return true;
    for (std::int32_t y = y0; y <= y1; ++y) {
      for (std::int32_t x = x0; x <= x1; ++x) {
        if (is_hot_[bit_of(x, y)]) return true;
      }
    }
    return false;
  }

 private:
  static constexpr std::uint32_t kBits = std::uint32_t{1} << 20;
  static constexpr std::int64_t kMostBlocks = 64;

  /// Blocks are about as large as the mean segment.
  static int shift_for(const std::vector<Segment>& segments) {
    double sum = 0;
    for (const auto& [a, b] : segments) {
      sum += std::max(std::abs(static_cast<double>(b.x) - a.x),
                      std::abs(static_cast<double>(b.y) - a.y));
    }
    const double mean = sum / static_cast<double>(std::max<std::size_t>(segments.size(), 1));
    return std::clamp(std::ilogb(std::max(mean, 1.0)), 1, 30);
  }
  static std::uint32_t bit_of(std::int32_t x, std::int32_t y) {
    return (static_cast<std::uint32_t>(x) * 0x9e3779b1u ^
            static_cast<std::uint32_t>(y) * 0x85ebca77u) >>
           12;
  }

  const int shift_;
  std::vector<bool> is_hot_;  // by hash
};

/// Hot cells in a tree, ordered so that cells near each other are found together.
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

/// Appends the pieces of a segment that passes through the cells, which are first sorted along the
/// segment: by the position of their centres in its direction.
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

std::optional<Noding> node(const std::vector<Segment>& segments, const Boundary& boundary,
                           HotCells cells, unsigned threads) {
  const std::optional<std::vector<Point>> hot = hot_cells(boundary, cells, threads);
  if (!hot) return std::nullopt;
  const HotTree tree(*hot);
  const HotBlocks blocks(*hot, segments);
  // A crossing is passed by two segments, the end of a segment by that segment; rounding adds some.
  constexpr std::size_t kPassesOfEach = 4;
  const std::size_t most_pieces =
      kPassesOfEach * (segments.size() + most_meetings(segments.size()));
  Noding noding;
  std::vector<Point> passed;
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    if (!blocks.may_pass_one(segments[i])) continue;
    passed.clear();
    tree.append_passed(segments[i], passed);
    const auto is_end = [&segment = segments[i]](Point p) {
      return p == segment.first || p == segment.second;
    };
    if (std::all_of(passed.begin(), passed.end(), is_end)) continue;
    noding.cut.push_back(i);
    add_pieces(segments[i], i, passed, noding.pieces);
    if (noding.pieces.size() > most_pieces) return std::nullopt;
  }
  return noding;
}

std::optional<std::vector<Segment>> node_segments(const std::vector<Segment>& segments,
                                                  const Boundary& boundary, HotCells cells) {
  const std::optional<Noding> noding = node(segments, boundary, cells);
  if (!noding) return std::nullopt;
  std::vector<Segment> pieces;
  pieces.reserve(segments.size() + noding->pieces.size());
  auto cut = noding->cut.begin();
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    if (cut != noding->cut.end() && *cut == i) {
      ++cut;
    } else {
      const auto& [a, b] = segments[i];
      pieces.push_back(is_above(a, b) ? Segment{a, b} : Segment{b, a});
    }
  }
  for (const Piece& piece : noding->pieces) pieces.push_back(piece.segment);
  cancel_pairs(pieces);
  return pieces;
}

}  // namespace trapeze
