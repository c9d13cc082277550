#include "core/mesh/seen_edges.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace trapeze {
namespace {

/// A piece of an edge between two of its coordinates.
struct Piece {
  std::uint32_t edge;
  std::int32_t begin;
  std::int32_t end;
  float share;
};

/// Sorts pieces, and joins those that continue where another one of the same share ends.
void join(std::vector<Piece>& pieces) {
  std::ranges::sort(pieces, {}, [](const Piece& piece) {
    return std::tuple(piece.edge, piece.share, piece.begin, piece.end);
  });
  std::size_t count = 0;
  for (const Piece& piece : pieces) {
    Piece* last = count > 0 ? &pieces[count - 1] : nullptr;
    if (last != nullptr && last->edge == piece.edge && last->share == piece.share &&
        piece.begin <= last->end) {
      last->end = std::max(last->end, piece.end);
    } else {
      pieces[count++] = piece;
    }
  }
  pieces.resize(count);
}

std::int32_t rounded(double cells) {
  return static_cast<std::int32_t>(std::floor(cells + 0.5));
}

/// The heights between which a line that is not horizontal lies in a box; there are none if the
/// first is greater.
std::pair<double, double> heights_within(const Box& box, Point upper, Point lower) {
  const double first = std::max(upper.y, box.min_y);
  const double last = std::min(lower.y, box.max_y);
  if (upper.x == lower.x) {
    return upper.x >= box.min_x && upper.x <= box.max_x ? std::pair(first, last)
                                                        : std::pair(last + 1, first);
  }
  const double slope =
      (static_cast<double>(lower.y) - upper.y) / (static_cast<double>(lower.x) - upper.x);
  const auto height_at = [&](double x) { return upper.y + (x - upper.x) * slope; };
  const double at_west = height_at(box.min_x);
  const double at_east = height_at(box.max_x);
  return {std::max(first, std::min(at_west, at_east)), std::min(last, std::max(at_west, at_east))};
}

/// The top or the bottom of a visible part.
struct LevelSide {
  std::int32_t y;
  std::int32_t begin;
  std::int32_t end;
  std::int32_t reach;  // the greatest end of the sides of this height up to this one
  float share;
};

/// The tops and bottoms at these heights, which are in ascending order; sorted by height, then by
/// begin.
std::vector<LevelSide> level_sides(const MeshView& mesh, std::span<const TrapezoidPart> parts,
                                   std::span<const std::int32_t> heights) {
  std::vector<LevelSide> sides;
  if (heights.empty()) return sides;
  for (const TrapezoidPart& part : parts) {
    for (const std::int32_t y : {part.top, part.bottom}) {
      if (!std::ranges::binary_search(heights, y)) continue;
      const std::int32_t begin = rounded(EdgeLine(mesh, part.left).x_at(y));
      const std::int32_t end = rounded(EdgeLine(mesh, part.right).x_at(y));
      if (begin < end) sides.push_back({y, begin, end, end, part.share});
    }
  }
  std::ranges::sort(sides, {}, [](const LevelSide& s) { return std::tuple(s.y, s.begin, s.end); });
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].y == sides[i - 1].y) sides[i].reach = std::max(sides[i].end, sides[i - 1].reach);
  }
  return sides;
}

}  // namespace

void append_seen_sides(const MeshView& mesh, std::span<const std::uint32_t> own,
                       const VisibleInBox& visible, std::vector<SeenEdge>& seen) {
  std::vector<Piece> pieces;
  for (const TrapezoidPart& part : visible.parts) {
    for (const std::uint32_t edge : {part.left, part.right}) {
      if (!std::ranges::binary_search(own, edge)) continue;
      pieces.push_back({edge, part.top, part.bottom, part.share});
    }
  }
  join(pieces);
  for (const Piece& piece : pieces) {
    const Point upper = mesh.vertices[mesh.edges[piece.edge].upper];
    const Point lower = mesh.vertices[mesh.edges[piece.edge].lower];
    const std::pair<double, double> within = heights_within(visible.box, upper, lower);
    const bool is_in_box =
        within.first <= within.second && piece.end > within.first && piece.begin < within.second;
    if (!is_in_box) continue;
    const EdgeLine line(upper, lower);
    const auto point_at = [&](std::int32_t y) {
      if (y <= within.first) return upper;
      return y >= within.second ? lower : Point{rounded(line.x_at(y)), y};
    };
    seen.push_back({piece.edge, point_at(piece.begin), point_at(piece.end), piece.share});
  }
}

void append_seen_level_edges(const MeshView& mesh, std::span<const std::uint32_t> edges,
                             const VisibleInBox& visible, std::vector<SeenEdge>& seen) {
  const Box& box = visible.box;
  const auto west_of = [&](std::uint32_t edge) { return mesh.vertices[mesh.edges[edge].upper]; };
  const auto east_of = [&](std::uint32_t edge) { return mesh.vertices[mesh.edges[edge].lower]; };
  std::vector<std::int32_t> heights;
  for (const std::uint32_t edge : edges) {
    const std::int32_t y = west_of(edge).y;
    if (y >= box.min_y && y <= box.max_y) heights.push_back(y);
  }
  std::ranges::sort(heights);
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  const std::vector<LevelSide> sides = level_sides(mesh, visible.parts, heights);
  std::vector<Piece> pieces;
  for (const std::uint32_t edge : edges) {
    const Point west = west_of(edge);
    const Point east = east_of(edge);
    auto side =
        std::ranges::lower_bound(sides, std::pair(west.y, west.x + 1), {},
                                 [](const LevelSide& s) { return std::pair(s.y, s.reach); });
    for (; side != sides.end() && side->y == west.y && side->begin < east.x; ++side) {
      const std::int32_t begin = std::max(side->begin, west.x);
      const std::int32_t end = std::min(side->end, east.x);
      if (begin < end) pieces.push_back({edge, begin, end, side->share});
    }
  }
  join(pieces);
  for (const Piece& piece : pieces) {
    if (piece.begin > box.max_x || piece.end < box.min_x) continue;
    const Point west = west_of(piece.edge);
    const std::int32_t begin = piece.begin <= box.min_x ? west.x : piece.begin;
    const std::int32_t end = piece.end >= box.max_x ? east_of(piece.edge).x : piece.end;
    seen.push_back({piece.edge, {begin, west.y}, {end, west.y}, piece.share});
  }
}

}  // namespace trapeze
