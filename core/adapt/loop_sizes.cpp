#include "core/adapt/loop_sizes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

namespace trapeze {
namespace {

/// What hangs together.
class Groups {
 public:
  explicit Groups(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) first_.push_back(static_cast<std::uint32_t>(i));
  }

  std::uint32_t first_of(std::uint32_t i) {
    while (first_[i] != i) i = first_[i] = first_[first_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = first_of(a);
    b = first_of(b);
    first_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> first_;
};

/// A loop, or an arc between junctions: edges with the same faces on their sides.
struct Piece {
  CornerId first;
  // What it adds to twice the area of the boundary on one of its sides, and takes from that on the
  // other; cells squared.
  Int128 doubled_area = 0;
  // By side, as one walks along it: the face, and its boundary with what that hangs together with.
  std::array<FaceId, 2> faces;
  std::array<std::uint32_t, 2> boundaries;
};

class Measuring {
 public:
  explicit Measuring(const TrapezoidalGraph& graph) : graph_(graph) {
    is_in_piece_.assign(graph.corners().size(), 0);
  }

  void measure(Table<EdgeId, LoopSize>& sizes) {
    const auto count = graph_.corners().size();
    for (std::size_t i = 0; i < count; ++i) {
      const Corner& corner = graph_.corner(CornerId(i));
      if (corner.is_alive() && corner.prev.is_none()) add_piece(CornerId(i));
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (graph_.corner(CornerId(i)).is_alive() && is_in_piece_[CornerId(i)] == 0) {
        add_piece(CornerId(i));
      }
    }
    join_at_junctions();
    sizes.assign(graph_.edges().size(), 0);
    for (const Piece& piece : pieces_) {
      const LoopSize size = loop_size_of(std::max(area_on(piece, kLeft), area_on(piece, kRight)));
      for_each_corner(piece.first, [&](CornerId, const Corner& corner) {
        if (!corner.edge.is_none()) sizes[corner.edge] = size;
      });
    }
  }

 private:
  template <typename Visit>
  void for_each_corner(CornerId first, const Visit& visit) const {
    CornerId c = first;
    do {
      const Corner& corner = graph_.corner(c);
      visit(c, corner);
      c = corner.next;
    } while (!c.is_none() && c != first);
  }

  void add_piece(CornerId first) {
    Piece piece{first, 0, {}, {}};
    const Corner& begin = graph_.corner(first);
    const Edge& edge = graph_.edge(begin.edge);
    const bool leads_down = begin.vertex == edge.end[kUp];
    for (const Side side : {kLeft, kRight}) {
      piece.faces[side] = edge.face[leads_down ? side : opposite(side)];
      piece.boundaries[side] = static_cast<std::uint32_t>(2 * pieces_.size() + side);
    }
    for_each_corner(first, [&](CornerId c, const Corner& corner) {
      is_in_piece_[c] = 1;
      if (!corner.next.is_none()) piece.doubled_area += doubled_area_from(corner);
      if (!corner.is_end()) return;
      for (const Side side : {kLeft, kRight}) {
        ends_.emplace_back(corner.vertex, piece.faces[side], piece.boundaries[side]);
      }
    });
    pieces_.push_back(piece);
  }

  // Between an edge and the origin.
  Int128 doubled_area_from(const Corner& corner) const {
    const Point a = graph_.point(corner.vertex);
    const Point b = graph_.point(graph_.corner(corner.next).vertex);
    return static_cast<Int128>(a.x) * b.y - static_cast<Int128>(b.x) * a.y;
  }

  void join_at_junctions() {
    std::sort(ends_.begin(), ends_.end());
    groups_ = Groups(2 * pieces_.size());
    for (std::size_t i = 1; i < ends_.size(); ++i) {
      const auto& [vertex, face, boundary] = ends_[i];
      const auto& [vertex_before, face_before, boundary_before] = ends_[i - 1];
      if (vertex == vertex_before && face == face_before) groups_.join(boundary, boundary_before);
    }
    doubled_areas_.assign(2 * pieces_.size(), 0);
    for (const Piece& piece : pieces_) {
      doubled_areas_[groups_.first_of(piece.boundaries[kLeft])] += piece.doubled_area;
      doubled_areas_[groups_.first_of(piece.boundaries[kRight])] -= piece.doubled_area;
    }
  }

  // Outside, features that touch have one boundary together, which is that of none of them.
  double area_on(const Piece& piece, Side side) {
    if (piece.faces[side] == kOutside) return 0;
    const std::uint32_t boundary = groups_.first_of(piece.boundaries[side]);
    return std::abs(static_cast<double>(doubled_areas_[boundary])) / 2;
  }

  const TrapezoidalGraph& graph_;
  std::vector<Piece> pieces_;
  Table<CornerId, std::uint8_t> is_in_piece_;
  std::vector<std::tuple<VertexId, FaceId, std::uint32_t>> ends_;  // of arcs, and boundaries there
  Groups groups_{0};
  std::vector<Int128> doubled_areas_;  // by first boundary of a group
};

}  // namespace

void measure_loop_sizes(const TrapezoidalGraph& graph, Table<EdgeId, LoopSize>& sizes) {
  Measuring(graph).measure(sizes);
}

}  // namespace trapeze
