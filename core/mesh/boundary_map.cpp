#include "core/mesh/boundary_map.h"

#include <algorithm>
#include <utility>

namespace trapeze {
namespace {

constexpr double kCellsPerEdge = 8;  // of the lattice, approximate maximum

/// Orders points by y, then x.
std::uint64_t order_of(Point p) {
  const auto from_least = [](std::int32_t v) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v) ^ 0x80000000U);
  };
  return from_least(p.y) << 32 | from_least(p.x);
}

Point point_of(std::uint64_t order) {
  const auto part = [](std::uint64_t v) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(v) ^ 0x80000000U);
  };
  return {part(order), part(order >> 32)};
}

/// For directions from one point: in order of their angles, from x to y.
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
  return {order_of(mesh.vertices[ends.upper]),
          order_of(mesh.vertices[ends.lower]),
          face,
          number,
          piece,
          edge};
}

void BoundaryMap::add(const MeshTrapezoid& trapezoid, std::uint32_t face) {
  add_side(trapezoid.left, face, true);
  add_side(trapezoid.right, face, false);
}

void BoundaryMap::add_side(std::uint32_t edge, std::uint32_t face, bool is_right) {
  const Face whole = Face{meshes_.size() - 1} << 32 | face;
  sides_.push_back(side_of(edge, whole, is_right ? 1 : 0));
}

void BoundaryMap::find(const Box& box, double distance) {
  unite_sides();
  link();
  index(box, distance);
}

// If several faces lie on one side, that side belongs to none: the faces overlap.
void BoundaryMap::unite_sides() {
  sort_sides(sides_, side_order_);
  sort_sides(cuts_, cut_order_);
  const auto place_of = [](const Side& side) { return std::pair(side.upper, side.lower); };
  const auto place_of_cut = [&](const KeyedIndex& cut) { return place_of(cuts_[cut.index]); };
  edges_.clear();
  names_.clear();
  for (std::size_t i = 0; i < side_order_.size();) {
    const auto place = place_of(sides_[side_order_[i].index]);
    Edge edge{point_of(place.first), point_of(place.second)};
    std::size_t end = i;
    std::array<bool, 2> is_crowded{};
    for (; end < side_order_.size(); ++end) {
      const Side& side = sides_[side_order_[end].index];
      if (place_of(side) != place) break;
      if (side.face == kNoFace) continue;
      Face& face = edge.faces[side.number];
      if (face != kNoFace && face != side.face) is_crowded[side.number] = true;
      face = side.face;
    }
    for (std::size_t side = 0; side < 2; ++side) {
      if (is_crowded[side]) edge.faces[side] = kNoFace;
    }
    edge.is_cut = std::ranges::binary_search(cut_order_, place, {}, place_of_cut);
    const bool is_within = edge.faces[0] != kNoFace && edge.faces[0] == edge.faces[1];
    const bool is_level = edge.upper.y == edge.lower.y;
    const bool is_bare = edge.faces[0] == kNoFace && edge.faces[1] == kNoFace && !is_level;
    if (!is_within && !is_bare) {
      const auto number = static_cast<std::uint32_t>(edges_.size());
      for (std::size_t k = i; k < end; ++k) {
        const Side& side = sides_[side_order_[k].index];
        const auto name = std::uint64_t{side.piece} << 32 | side.edge;
        if (names_.empty() || names_.back().key != name) names_.push_back({name, number});
      }
      edges_.push_back(edge);
    }
    i = end;
  }
  sort(names_);
}

void BoundaryMap::sort(std::vector<KeyedIndex>& items) {
  scratch_.resize(items.size());
  sort_part_by_key(items, scratch_);
}

void BoundaryMap::sort_sides(std::span<const Side> sides, std::vector<KeyedIndex>& places) {
  places.clear();
  for (std::uint32_t i = 0; i < sides.size(); ++i) places.push_back({sides[i].upper, i});
  sort(places);
  for (std::size_t i = 0; i < places.size();) {
    std::size_t end = i + 1;
    while (end < places.size() && places[end].key == places[i].key) ++end;
    std::ranges::sort(std::span(places).subspan(i, end - i), {},
                      [sides](const KeyedIndex& one) { return sides[one.index].lower; });
    i = end;
  }
}

std::uint32_t BoundaryMap::edge_number(std::uint32_t piece, std::uint32_t edge) const {
  const auto name = std::uint64_t{piece} << 32 | edge;
  const auto found = std::ranges::lower_bound(names_, name, {}, &KeyedIndex::key);
  return found != names_.end() && found->key == name ? found->index : kNone;
}

// Faces of horizontal edges are found from the edges next to them, around either end. If those are
// horizontal too, this takes as many rounds as there are horizontal edges in a row.
void BoundaryMap::link() {
  sort_ends();
  next_.assign(2 * edges_.size(), kNone);
  before_.assign(2 * edges_.size(), kNone);
  constexpr int kMostRounds = 16;
  for (std::size_t i = 0; i < ends_.size();) {
    std::size_t end = i + 1;
    while (end < ends_.size() && ends_[end].at == ends_[i].at) ++end;
    sort_around(std::span(ends_).subspan(i, end - i));
    i = end;
  }
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

// Sorts ends by place; the edges are already in order of their upper ends.
void BoundaryMap::sort_ends() {
  lower_ends_.clear();
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    lower_ends_.push_back({order_of(edges_[i].lower), i});
  }
  sort(lower_ends_);
  ends_.clear();
  auto lower = lower_ends_.begin();
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    const std::uint64_t upper = order_of(edges_[i].upper);
    for (; lower != lower_ends_.end() && lower->key < upper; ++lower) {
      ends_.push_back({lower->key, lower->index, false});
    }
    ends_.push_back({upper, i, true});
  }
  for (; lower != lower_ends_.end(); ++lower) {
    ends_.push_back({lower->key, lower->index, false});
  }
}

/// Sorts ends at one place by the angles at which their edges leave it.
void BoundaryMap::sort_around(std::span<End> ends) const {
  if (ends.size() < 2) return;
  const Point at = point_of(ends.front().at);
  std::ranges::sort(ends, [this, at](const End& a, const End& b) {
    return is_turned_less(at, other_end(a), other_end(b));
  });
}

Point BoundaryMap::other_end(const End& end) const {
  return end.is_upper ? edges_[end.edge].lower : edges_[end.edge].upper;
}

// Between two successive directions from the vertex lies a face: on the side of the first edge
// towards the second, and on the side of the second towards the first. Returns whether a face has
// become known.
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
    const auto is_level = [this](const End& end) {
      return edges_[end.edge].upper.y == edges_[end.edge].lower.y;
    };
    if (of_out == kNoFace && of_in != kNoFace && is_level(one)) take(of_out, of_in);
    if (of_in == kNoFace && of_out != kNoFace && is_level(other)) take(of_in, of_out);
    if (of_out == kNoFace || of_out != of_in) continue;
    next_[in] = out;
    before_[out] = in;
  }
  return has_more;
}

template <typename Visit>
void BoundaryMap::for_each_cell(const Edge& edge, const Visit& visit) const {
  const Vector from = edge.from();
  const Vector way = edge.way();
  const int first_row = row_of(from.y);
  const int last_row = row_of(from.y + way.y);
  for (int row = first_row; row <= last_row; ++row) {
    // For the part of the edge in this row; the outermost rows extend to the end of the content.
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

// Cells are about as large as edges are long, so each edge is in few cells and each cell has few
// edges; but there are not more cells than items to put into them.
void BoundaryMap::index(const Box& box, double distance) {
  corner_ = {static_cast<double>(box.min_x), static_cast<double>(box.min_y)};
  const double width = static_cast<double>(box.max_x) - box.min_x;
  const double height = static_cast<double>(box.max_y) - box.min_y;
  double along = 0;
  for (const Edge& edge : edges_) {
    const Vector way = edge.way();
    along += std::min(std::abs(way.x) + std::abs(way.y), distance);
  }
  const double count = static_cast<double>(std::max<std::size_t>(edges_.size(), 1));
  const double least = std::sqrt(width * height / (kCellsPerEdge * count));
  cell_ = std::max({std::min(distance, along / count), least, 1.0});
  per_cell_ = 1 / cell_;
  columns_ = static_cast<int>(width / cell_) + 1;
  rows_ = static_cast<int>(height / cell_) + 1;
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  cell_end_.assign(cells + 1, 0);
  for (const Edge& edge : edges_) {
    if (!edge.is_cut) for_each_cell(edge, [this](std::size_t i) { ++cell_end_[i + 1]; });
  }
  for (std::size_t i = 1; i <= cells; ++i) cell_end_[i] += cell_end_[i - 1];
  cell_edges_.resize(cell_end_[cells]);
  // Starts as the begin of each cell, and becomes its end.
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    const Edge& edge = edges_[i];
    if (edge.is_cut) continue;
    const std::array<bool, 2> has_face{edge.faces[0] != kNoFace, edge.faces[1] != kNoFace};
    for_each_cell(edge, [&](std::size_t cell) {
      cell_edges_[cell_end_[cell]++] = {edge.upper, edge.lower, i, has_face};
    });
  }
}

}  // namespace trapeze
