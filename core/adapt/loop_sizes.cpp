#include "core/adapt/loop_sizes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

namespace trapeze {
namespace {

/// Groups of connected items.
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
  // The area that it adds, doubled, to the features on its left when followed, and subtracts from
  // those on its right; cells squared.
  Int128 doubled_area = 0;
  // In boundaries_: those of features that are on only one of its sides.
  std::uint32_t first_boundary = 0;
  std::uint32_t end_boundary = 0;
};

/// A part of the boundary of a feature.
struct FeatureBoundary {
  std::uint32_t feature = 0;
  bool is_on_left = false;
};

class Measuring {
 public:
  Measuring(const TrapezoidalGraph& graph, const FaceFeatures& faces)
      : graph_(graph), faces_(faces) {
    is_in_piece_.assign(graph.corners().size(), 0);
  }

  void measure(Table<EdgeId, LoopSize>& sizes) {
    const auto count = graph_.corners().size();
    const auto begins = [](const Corner& corner) {
      return corner.is_alive() && corner.prev.is_none();
    };
    const auto arcs = static_cast<std::size_t>(
        std::count_if(graph_.corners().begin(), graph_.corners().end(), begins));
    pieces_.reserve(arcs);
    boundaries_.reserve(arcs);
    ends_.reserve(2 * arcs);
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
      const LoopSize size = loop_size_of(greatest_area(piece));
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
    Piece piece{first};
    const Corner& begin = graph_.corner(first);
    const Edge& edge = graph_.edge(begin.edge);
    const bool leads_down = begin.vertex == edge.end[kUp];
    const auto left = faces_.of(edge.face[leads_down ? kLeft : kRight]);
    const auto right = faces_.of(edge.face[leads_down ? kRight : kLeft]);
    piece.first_boundary = static_cast<std::uint32_t>(boundaries_.size());
    for_each_apart(left, right, [this](std::uint32_t i) { boundaries_.push_back({i, true}); });
    for_each_apart(right, left, [this](std::uint32_t i) { boundaries_.push_back({i, false}); });
    piece.end_boundary = static_cast<std::uint32_t>(boundaries_.size());
    for_each_corner(first, [&](CornerId c, const Corner& corner) {
      is_in_piece_[c] = 1;
      if (!corner.next.is_none()) piece.doubled_area += doubled_area_from(corner);
      if (!corner.is_end()) return;
      for (std::uint32_t i = piece.first_boundary; i < piece.end_boundary; ++i) {
        ends_.emplace_back(corner.vertex, boundaries_[i].feature, i);
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
    groups_ = Groups(boundaries_.size());
    for (std::size_t i = 1; i < ends_.size(); ++i) {
      const auto& [vertex, feature, boundary] = ends_[i];
      const auto& [vertex_before, feature_before, boundary_before] = ends_[i - 1];
      const bool hang_together = vertex == vertex_before && feature == feature_before;
      if (hang_together) groups_.join(boundary, boundary_before);
    }
    doubled_areas_.assign(boundaries_.size(), 0);
    for (const Piece& piece : pieces_) {
      for (std::uint32_t i = piece.first_boundary; i < piece.end_boundary; ++i) {
        Int128& doubled_area = doubled_areas_[groups_.first_of(i)];
        doubled_area += boundaries_[i].is_on_left ? piece.doubled_area : -piece.doubled_area;
      }
    }
  }

  double greatest_area(const Piece& piece) {
    double greatest = 0;
    for (std::uint32_t i = piece.first_boundary; i < piece.end_boundary; ++i) {
      const Int128 doubled_area = doubled_areas_[groups_.first_of(i)];
      greatest = std::max(greatest, std::abs(static_cast<double>(doubled_area)) / 2);
    }
    return greatest;
  }

  const TrapezoidalGraph& graph_;
  const FaceFeatures& faces_;
  std::vector<Piece> pieces_;
  std::vector<FeatureBoundary> boundaries_;  // by piece
  Table<CornerId, std::uint8_t> is_in_piece_;
  std::vector<std::tuple<VertexId, std::uint32_t, std::uint32_t>>
      ends_;  // ends of arcs, with the boundaries there
  Groups groups_{0};
  std::vector<Int128> doubled_areas_;  // by first boundary of a group
};

}  // namespace

void measure_loop_sizes(const TrapezoidalGraph& graph, const FaceFeatures& faces,
                        Table<EdgeId, LoopSize>& sizes) {
  Measuring(graph, faces).measure(sizes);
}

}  // namespace trapeze
