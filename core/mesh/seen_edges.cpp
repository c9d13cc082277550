#include "core/mesh/seen_edges.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace trapeze {
namespace {

/// A piece of an edge between two of its coordinates.
struct Piece {
  std::uint32_t edge;
  std::int32_t begin;
  std::int32_t end;
  float share;
};

/// Sorts pieces, and joins those that go on where another one of the same share ends.
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

}  // namespace

void append_seen_sides(const MeshView& mesh, std::span<const std::uint32_t> own,
                       std::span<const TrapezoidPart> parts, std::vector<SeenEdge>& seen) {
  std::vector<Piece> pieces;
  for (const TrapezoidPart& part : parts) {
    for (const std::uint32_t edge : {part.left, part.right}) {
      if (!std::ranges::binary_search(own, edge)) continue;
      pieces.push_back({edge, part.top, part.bottom, part.share});
    }
  }
  join(pieces);
  for (const Piece& piece : pieces) {
    const Point upper = mesh.vertices[mesh.edges[piece.edge].upper];
    const Point lower = mesh.vertices[mesh.edges[piece.edge].lower];
    const EdgeLine line(upper, lower);
    const auto point_at = [&](std::int32_t y) {
      if (y <= upper.y) return upper;
      return y >= lower.y ? lower : Point{rounded(line.x_at(y)), y};
    };
    seen.push_back({piece.edge, point_at(piece.begin), point_at(piece.end), piece.share});
  }
}

void append_seen_level_edge(const MeshView& mesh, std::uint32_t edge,
                            std::span<const TrapezoidPart> parts, std::vector<SeenEdge>& seen) {
  const Point west = mesh.vertices[mesh.edges[edge].upper];
  const Point east = mesh.vertices[mesh.edges[edge].lower];
  std::vector<Piece> pieces;
  for (const TrapezoidPart& part : parts) {
    if (part.top != west.y && part.bottom != west.y) continue;
    const std::int32_t begin = std::max(rounded(EdgeLine(mesh, part.left).x_at(west.y)), west.x);
    const std::int32_t end = std::min(rounded(EdgeLine(mesh, part.right).x_at(west.y)), east.x);
    if (begin < end) pieces.push_back({edge, begin, end, part.share});
  }
  join(pieces);
  for (const Piece& piece : pieces) {
    seen.push_back({edge, {piece.begin, west.y}, {piece.end, west.y}, piece.share});
  }
}

}  // namespace trapeze
