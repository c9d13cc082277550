#include "core/mesh/boundary_map.h"

#include <algorithm>
#include <tuple>

namespace trapeze {
namespace {

constexpr int kMostCellsAcross = 512;

auto place_of(Point p) {
  return std::pair(p.y, p.x);
}

/// Of ways from one point: in order of their angles, from x to y.
bool is_turned_less(Point at, Point a, Point b) {
  const auto is_lower_half = [at](Point p) { return p.y < at.y || (p.y == at.y && p.x < at.x); };
  const bool of_a = is_lower_half(a);
  const bool of_b = is_lower_half(b);
  if (of_a != of_b) return of_b;
  return orientation(at, a, b) > 0;
}

}  // namespace

void BoundaryMap::begin() {
  meshes_.clear();
  sides_.clear();
  cuts_.clear();
}

void BoundaryMap::begin_piece(const MeshView& mesh) {
  meshes_.push_back(mesh);
}

BoundaryMap::Side BoundaryMap::side_of(std::uint32_t edge, Face face, std::uint32_t number) const {
  const MeshView& mesh = meshes_.back();
  const MeshEdge& ends = mesh.edges[edge];
  const auto piece = static_cast<std::uint32_t>(meshes_.size() - 1);
  return {mesh.vertices[ends.upper], mesh.vertices[ends.lower], face, number, piece, edge};
}

void BoundaryMap::add(const MeshTrapezoid& trapezoid, std::uint32_t face) {
  const Face whole = Face{meshes_.size() - 1} << 32 | face;
  sides_.push_back(side_of(trapezoid.left, whole, 1));
  sides_.push_back(side_of(trapezoid.right, whole, 0));
}

void BoundaryMap::find(const Box& box, double distance) {
  unite_sides();
  link();
  index(box, distance);
}

// Where several faces lie on one side, that is of none: they lie over each other.
void BoundaryMap::unite_sides() {
  const auto key = [](const Side& side) {
    return std::tuple(place_of(side.upper), place_of(side.lower));
  };
  const auto order = [&key](const Side& a, const Side& b) {
    return std::tuple_cat(key(a), std::tuple(a.piece, a.edge)) <
           std::tuple_cat(key(b), std::tuple(b.piece, b.edge));
  };
  std::ranges::sort(sides_, order);
  std::ranges::sort(cuts_, order);
  edges_.clear();
  names_.clear();
  for (std::size_t i = 0; i < sides_.size();) {
    Edge edge{sides_[i].upper, sides_[i].lower};
    const auto key_of_edge = key(sides_[i]);
    std::size_t end = i;
    std::array<bool, 2> is_crowded{};
    for (; end < sides_.size() && key(sides_[end]) == key_of_edge; ++end) {
      const Side& side = sides_[end];
      if (side.face == kNoFace) continue;
      Face& face = edge.faces[side.number];
      if (face != kNoFace && face != side.face) is_crowded[side.number] = true;
      face = side.face;
    }
    for (std::size_t side = 0; side < 2; ++side) {
      if (is_crowded[side]) edge.faces[side] = kNoFace;
    }
    const auto cut = std::ranges::lower_bound(cuts_, key_of_edge, {}, key);
    edge.is_cut = cut != cuts_.end() && key(*cut) == key_of_edge;
    const bool is_within = edge.faces[0] != kNoFace && edge.faces[0] == edge.faces[1];
    const bool is_level = edge.upper.y == edge.lower.y;
    const bool is_bare = edge.faces[0] == kNoFace && edge.faces[1] == kNoFace && !is_level;
    if (!is_within && !is_bare) {
      const auto number = static_cast<std::uint32_t>(edges_.size());
      for (std::size_t k = i; k < end; ++k) {
        const auto name = std::uint64_t{sides_[k].piece} << 32 | sides_[k].edge;
        if (names_.empty() || names_.back().piece_and_edge != name) {
          names_.push_back({name, number});
        }
      }
      edges_.push_back(edge);
    }
    i = end;
  }
  std::ranges::sort(names_, {}, &Name::piece_and_edge);
}

std::uint32_t BoundaryMap::edge_number(std::uint32_t piece, std::uint32_t edge) const {
  const auto name = std::uint64_t{piece} << 32 | edge;
  const auto found = std::ranges::lower_bound(names_, name, {}, &Name::piece_and_edge);
  return found != names_.end() && found->piece_and_edge == name ? found->number : kNone;
}

// Faces of horizontal edges are those of the edges beside them, around either end; where those are
// horizontal, too, it takes as many rounds as there are in a row.
void BoundaryMap::link() {
  ends_.clear();
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    ends_.push_back({edges_[i].upper, edges_[i].lower, i, true});
    ends_.push_back({edges_[i].lower, edges_[i].upper, i, false});
  }
  std::ranges::sort(ends_, [](const End& a, const End& b) {
    if (a.at != b.at) return place_of(a.at) < place_of(b.at);
    return is_turned_less(a.at, a.other, b.other);
  });
  next_.assign(2 * edges_.size(), kNone);
  before_.assign(2 * edges_.size(), kNone);
  constexpr int kMostRounds = 16;
  bool has_more = true;
  for (int round = 0; round < kMostRounds && has_more; ++round) {
    has_more = false;
    for (std::size_t i = 0; i < ends_.size();) {
      std::size_t end = i + 1;
      while (end < ends_.size() && ends_[end].at == ends_[i].at) ++end;
      has_more = link_around(std::span(ends_).subspan(i, end - i)) || has_more;
      i = end;
    }
  }
}

// Between one way from the vertex and the next lies a face: on that side of the one to which it is
// turned, and on the other side of the next. Whether a face has become known.
bool BoundaryMap::link_around(std::span<const End> ends) {
  bool has_more = false;
  for (std::size_t i = 0; i < ends.size() && ends.size() > 1; ++i) {
    const End& one = ends[i];
    const End& other = ends[i + 1 < ends.size() ? i + 1 : 0];
    const std::uint32_t out = 2 * one.edge + (one.is_upper ? 0 : 1);
    const std::uint32_t in = 2 * other.edge + (other.is_upper ? 1 : 0);
    Face& of_out = edges_[out / 2].faces[out % 2];
    Face& of_in = edges_[in / 2].faces[in % 2];
    const auto take = [&has_more](Face& to, Face from) {
      to = from;
      has_more = true;
    };
    if (of_out == kNoFace && of_in != kNoFace && one.at.y == one.other.y) take(of_out, of_in);
    if (of_in == kNoFace && of_out != kNoFace && other.at.y == other.other.y) take(of_in, of_out);
    if (of_out == kNoFace || of_out != of_in) continue;
    next_[in] = out;
    before_[out] = in;
  }
  return has_more;
}

int BoundaryMap::column_of(double x) const {
  return static_cast<int>(std::clamp((x - corner_.x) / cell_, 0.0, columns_ - 1.0));
}

int BoundaryMap::row_of(double y) const {
  return static_cast<int>(std::clamp((y - corner_.y) / cell_, 0.0, rows_ - 1.0));
}

template <typename Visit>
void BoundaryMap::for_each_cell(const Edge& edge, const Visit& visit) const {
  const Vector from = edge.from();
  const Vector way = edge.way();
  const int first_row = row_of(from.y);
  const int last_row = row_of(from.y + way.y);
  for (int row = first_row; row <= last_row; ++row) {
    // Of the part of the edge in this row; the outermost rows reach as far as there is something.
    const auto x_at = [&](double y) {
      return way.y == 0 ? from.x : from.x + way.x * std::clamp((y - from.y) / way.y, 0.0, 1.0);
    };
    double begin = row == first_row ? from.x : x_at(corner_.y + row * cell_);
    double end = row == last_row ? from.x + way.x : x_at(corner_.y + (row + 1) * cell_);
    if (begin > end) std::swap(begin, end);
    const int last_column = column_of(end + 1);
    for (int column = column_of(begin - 1); column <= last_column; ++column) {
      visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
            static_cast<std::size_t>(column));
    }
  }
}

void BoundaryMap::index(const Box& box, double distance) {
  corner_ = {static_cast<double>(box.min_x), static_cast<double>(box.min_y)};
  const double width = static_cast<double>(box.max_x) - box.min_x;
  const double height = static_cast<double>(box.max_y) - box.min_y;
  cell_ = std::max({distance, width / kMostCellsAcross, height / kMostCellsAcross, 1.0});
  columns_ = static_cast<int>(width / cell_) + 1;
  rows_ = static_cast<int>(height / cell_) + 1;
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  cell_end_.assign(cells + 1, 0);
  for (const Edge& edge : edges_)
    for_each_cell(edge, [this](std::size_t i) { ++cell_end_[i + 1]; });
  for (std::size_t i = 1; i <= cells; ++i) cell_end_[i] += cell_end_[i - 1];
  cell_edges_.resize(cell_end_[cells]);
  // Counted from the begin of each cell, which becomes its end.
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    for_each_cell(edges_[i], [this, i](std::size_t cell) { cell_edges_[cell_end_[cell]++] = i; });
  }
  seen_.assign(edges_.size(), 0);
  look_up_ = 0;
}

}  // namespace trapeze
