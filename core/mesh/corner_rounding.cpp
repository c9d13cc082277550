#include "core/mesh/corner_rounding.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/grid/ring_box.h"

namespace trapeze {
namespace {

// Maximum distance of a chord from its curve, in pixels.
constexpr double kMostOff = 0.04;
constexpr int kMostHalves = 12;  // maximum number of chords of each half of a curve

// Triangles of a smaller area, in square pixels, are not worth rounding: a third of the triangle
// changes its face, which no pixel shows as more than 1/255.
constexpr double kLeastArea = 0.01;

double distance(Point a, Point b) {
  const double x = static_cast<double>(b.x) - a.x;
  const double y = static_cast<double>(b.y) - a.y;
  return std::sqrt(x * x + y * y);
}

/// The point at the fraction `share` of the way from one point to the other.
Point point_towards(Point from, Point to, double share) {
  const auto between = [share](std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(std::lround(a + (static_cast<double>(b) - a) * share));
  };
  return {between(from.x, to.x), between(from.y, to.y)};
}

/// The point after i of n steps on the parabola from a to b that bends towards the tip, rounded to
/// a cell. Symmetric in the direction.
Point point_on_curve(Point a, Point tip, Point b, int i, int n) {
  const auto at = [i, n](std::int64_t from, std::int64_t by, std::int64_t to) {
    const std::int64_t whole = std::int64_t{n} * n;
    const std::int64_t sum = (n - i) * std::int64_t{n - i} * from +
                             std::int64_t{2} * i * (n - i) * by + std::int64_t{i} * i * to;
    const std::int64_t rounded = 2 * sum + whole;
    const std::int64_t below = rounded / (2 * whole) - (rounded % (2 * whole) < 0 ? 1 : 0);
    return static_cast<std::int32_t>(below);
  };
  return {at(a.x, tip.x, b.x), at(a.y, tip.y, b.y)};
}

/// The number of chords of half the curve such that none is more than kMostOff pixels away from it.
int halves_of(Point a, Point tip, Point b, double pixel) {
  const double x = static_cast<double>(a.x) - 2.0 * tip.x + b.x;
  const double y = static_cast<double>(a.y) - 2.0 * tip.y + b.y;
  const double bend = std::sqrt(x * x + y * y) / pixel;
  const double chords = std::ceil(std::sqrt(bend / (4 * kMostOff)) / 2);
  return static_cast<int>(std::clamp(chords, 1.0, double{kMostHalves}));
}

/// Whether the point lies in the triangle, including its sides. The corners may be in either
/// orientation.
bool holds(const std::array<Point, 3>& triangle, Point p) {
  int left = 0;
  int right = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t side = orientation(triangle[i], triangle[(i + 1) % 3], p);
    left += side < 0 ? 1 : 0;
    right += side > 0 ? 1 : 0;
  }
  return left == 0 || right == 0;
}

/// Appends the triangle of three vertices. `sides` are the edges between the first and the second,
/// the second and the third, the third and the first.
void append_triangle(const std::array<std::uint32_t, 3>& corners,
                     const std::array<std::uint32_t, 3>& sides, bool is_hole,
                     const std::vector<Point>& vertices, std::vector<MeshTrapezoid>& trapezoids) {
  std::array<std::size_t, 3> order{0, 1, 2};
  std::ranges::sort(order, is_above, [&](std::size_t i) { return vertices[corners[i]]; });
  const auto [a, b, c] = order;
  const auto side_between = [&](std::size_t i, std::size_t j) {
    if ((i + 1) % 3 == j) return sides[i];
    return sides[j];
  };
  const auto point = [&](std::size_t i) { return vertices[corners[i]]; };
  const std::int64_t middle = orientation(point(a), point(c), point(b));
  if (middle == 0) return;
  const std::uint32_t through = side_between(a, c);
  const auto append = [&](std::size_t top, std::size_t bottom) {
    if (point(top).y == point(bottom).y) return;
    const std::uint32_t other = side_between(top, bottom);
    const bool is_other_right = (middle < 0) != is_hole;
    trapezoids.push_back({corners[top], corners[bottom], is_other_right ? through : other,
                          is_other_right ? other : through});
  };
  append(a, b);
  append(b, c);
}

}  // namespace

void CornerRounding::begin() {
  meshes_.clear();
  sides_.clear();
  corners_.clear();
  points_.clear();
}

void CornerRounding::begin_piece(const MeshView& mesh) {
  meshes_.push_back(mesh);
}

void CornerRounding::add(const MeshTrapezoid& trapezoid, std::uint32_t face, bool is_sharp) {
  add_side(trapezoid.left, face, true, is_sharp);
  add_side(trapezoid.right, face, false, is_sharp);
}

void CornerRounding::add_side(std::uint32_t edge, std::uint32_t face, bool is_right,
                              bool is_sharp) {
  const auto piece = static_cast<std::uint32_t>(meshes_.size() - 1);
  sides_.push_back({piece, edge, face, is_right, is_sharp});
}

void CornerRounding::add_edge(std::uint32_t edge, bool is_sharp) {
  const auto piece = static_cast<std::uint32_t>(meshes_.size() - 1);
  sides_.push_back({piece, edge, kNoFace, false, is_sharp});
}

void CornerRounding::unite_sides() {
  std::ranges::sort(sides_);
  edges_.clear();
  for (const Side& side : sides_) {
    const bool is_new =
        edges_.empty() || edges_.back().piece != side.piece || edges_.back().edge != side.edge;
    if (is_new) {
      const MeshView& mesh = meshes_[side.piece];
      const MeshEdge& ends = mesh.edges[side.edge];
      const auto key = [&](std::uint32_t vertex) { return VertexKey{side.piece} << 32 | vertex; };
      edges_.push_back({side.piece, side.edge, key(ends.upper), key(ends.lower),
                        mesh.vertices[ends.upper], mesh.vertices[ends.lower]});
    }
    Edge& edge = edges_.back();
    edge.is_sharp = edge.is_sharp || side.is_sharp;
    if (side.face == kNoFace) continue;
    std::uint32_t& face = side.is_right ? edge.right : edge.left;
    if (face != kNoFace && face != side.face) edge.is_sharp = true;
    face = side.face;
  }
}

std::uint64_t CornerRounding::cell_of(std::int64_t x, std::int64_t y) const {
  const auto number = [this](std::int64_t v) {
    return static_cast<std::uint64_t>((v - kGridMin) / cell_side_);
  };
  return number(y) << 32 | number(x);
}

void CornerRounding::find_places() {
  ends_.clear();
  places_.clear();
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    ends_.push_back({edges_[i].upper_key, i});
    ends_.push_back({edges_[i].lower_key, i});
  }
  std::ranges::sort(ends_);
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    if (i > 0 && ends_[i - 1].key == ends_[i].key) continue;
    const Edge& edge = edges_[ends_[i].edge];
    const Point point = edge.upper_key == ends_[i].key ? edge.upper : edge.lower;
    places_.push_back({cell_of(point.x, point.y), point, ends_[i].key});
  }
  std::ranges::sort(places_, {}, &Place::cell);
}

void CornerRounding::find(const Size& size) {
  unite_sides();
  // About as long as the mean side of a triangle, so that few vertices are examined for each.
  double sides = 0;
  for (const Edge& edge : edges_) {
    sides += std::min(distance(edge.upper, edge.lower) / 2, size.radius * size.pixel);
  }
  cell_side_ = 1 + static_cast<std::int64_t>(sides / static_cast<double>(edges_.size() + 1));
  find_places();
  for (std::size_t i = 0; i < ends_.size();) {
    std::size_t end = i + 1;
    while (end < ends_.size() && ends_[end].key == ends_[i].key) ++end;
    if (end - i == 2) {
      const Edge& first = edges_[ends_[i].edge];
      const Edge& second = edges_[ends_[i + 1].edge];
      if (!first.is_sharp && !second.is_sharp) round_corner(ends_[i].key, first, second, size);
    }
    i = end;
  }
}

bool CornerRounding::is_empty(const std::array<Point, 3>& triangle, VertexKey tip) const {
  Box box;
  for (const Point p : triangle) box.include(p);
  for (std::int64_t y = box.min_y;; y += cell_side_) {
    y = std::min<std::int64_t>(y, box.max_y);
    auto place = std::ranges::lower_bound(places_, cell_of(box.min_x, y), {}, &Place::cell);
    const std::uint64_t last = cell_of(box.max_x, y);
    for (; place != places_.end() && place->cell <= last; ++place) {
      if (place->key != tip && holds(triangle, place->point)) return false;
    }
    if (y == box.max_y) return true;
  }
}

/// The faces on the side of the edge where a point lies, and on the other side; none for a
/// horizontal edge.
std::optional<std::pair<std::uint32_t, std::uint32_t>> CornerRounding::faces_beside(
    const Edge& edge, Point inner) {
  if (edge.is_level()) return std::nullopt;
  const bool is_right = orientation(edge.upper, edge.lower, inner) < 0;
  return is_right ? std::pair(edge.right, edge.left) : std::pair(edge.left, edge.right);
}

void CornerRounding::round_corner(VertexKey key, const Edge& first, const Edge& second,
                                  const Size& size) {
  const std::array<const Edge*, 2> edges{&first, &second};
  const Point tip = first.upper_key == key ? first.upper : first.lower;
  if (!holds(size.tips, {tip.x, tip.y, tip.x, tip.y})) return;
  const double pixel = size.pixel;
  Corner corner;
  std::array<Point, 2> ends;
  for (std::size_t i = 0; i < 2; ++i) {
    const Point other = edges[i]->upper_key == key ? edges[i]->lower : edges[i]->upper;
    corner.edges[i] = edges[i]->edge;
    corner.shares[i] = std::min(0.5, size.radius * pixel / distance(tip, other));
    ends[i] = point_towards(tip, other, corner.shares[i]);
  }
  const double area = std::abs(static_cast<double>(orientation(ends[0], tip, ends[1]))) / 2;
  if (area == 0 || area < kLeastArea * pixel * pixel) return;
  if (!is_empty({ends[0], tip, ends[1]}, key)) return;
  const auto faces = faces_beside(first, ends[1]);
  const auto faces_of_second = faces_beside(second, ends[0]);
  if (!faces && !faces_of_second) return;
  if (faces && faces_of_second && *faces != *faces_of_second) return;
  std::tie(corner.inside, corner.outside) = faces ? *faces : *faces_of_second;
  corner.piece = first.piece;
  corner.vertex = static_cast<std::uint32_t>(key);
  corner.tip = tip;
  const int chords = 2 * halves_of(ends[0], tip, ends[1], pixel);
  corner.first_point = static_cast<std::uint32_t>(points_.size());
  corner.point_count = static_cast<std::uint32_t>(chords) + 1;
  for (int i = 0; i <= chords; ++i) {
    points_.push_back(point_on_curve(ends[0], tip, ends[1], i, chords));
  }
  corners_.push_back(corner);
}

const CornerRounding::Corner* CornerRounding::corner_at(std::uint32_t piece,
                                                        std::uint32_t vertex) const {
  const auto key = [](const Corner& corner) { return std::pair(corner.piece, corner.vertex); };
  const auto found = std::ranges::lower_bound(corners_, std::pair(piece, vertex), {}, key);
  return found != corners_.end() && key(*found) == std::pair(piece, vertex) ? &*found : nullptr;
}

void CornerRounding::leave_sharp(std::uint32_t piece, std::span<const std::uint32_t> vertices) {
  std::erase_if(corners_, [&](const Corner& corner) {
    return corner.piece == piece && std::ranges::binary_search(vertices, corner.vertex);
  });
}

void CornerRounding::trace(std::uint32_t piece, const MeshView& mesh, std::uint32_t edge,
                           std::vector<PlateCarreeMesh::PointOnWay>& way) const {
  const auto append = [&way](Point place, double share) {
    if (way.empty() || way.back().place != place) way.push_back({place, share});
  };
  // Appends from the middle of the curve to its end on the edge, or in reverse.
  const auto append_half = [&](const Corner& corner, bool is_at_lower) {
    const std::span<const Point> points = points_of(corner);
    const std::size_t half = points.size() / 2;
    const bool is_second = corner.edges[1] == edge;
    const double share = corner.shares[is_second ? 1 : 0];
    for (std::size_t i = 0; i <= half; ++i) {
      const std::size_t to_end = is_at_lower ? half - i : i;  // steps from the middle
      const std::size_t at = is_second ? half + to_end : half - to_end;
      const double gone = share * static_cast<double>(to_end) / static_cast<double>(half);
      append(points[at], is_at_lower ? 1 - gone : gone);
    }
  };
  const MeshEdge& ends = mesh.edges[edge];
  way.clear();
  const Corner* upper = corner_at(piece, ends.upper);
  const Corner* lower = corner_at(piece, ends.lower);
  if (upper == nullptr) append(mesh.vertices[ends.upper], 0);
  if (upper != nullptr) append_half(*upper, false);
  if (lower != nullptr) append_half(*lower, true);
  if (lower == nullptr) append(mesh.vertices[ends.lower], 1);
}

// A fan of triangles around the tip, from which the whole curve is visible.
void CornerRounding::append_place(const Corner& corner, bool is_hole, std::vector<Point>& vertices,
                                  std::vector<MeshEdge>& edges,
                                  std::vector<MeshTrapezoid>& trapezoids) const {
  const std::span<const Point> points = points_of(corner);
  const auto tip = static_cast<std::uint32_t>(vertices.size());
  vertices.push_back(corner.tip);
  vertices.insert(vertices.end(), points.begin(), points.end());
  const auto append_edge = [&](std::uint32_t from, std::uint32_t to) {
    const bool goes_down = is_above(vertices[from], vertices[to]);
    edges.push_back(goes_down ? MeshEdge{from, to} : MeshEdge{to, from});
    return static_cast<std::uint32_t>(edges.size() - 1);
  };
  std::uint32_t ray = append_edge(tip, tip + 1);
  for (std::uint32_t i = 1; i < points.size(); ++i) {
    const std::uint32_t chord = append_edge(tip + i, tip + i + 1);
    const std::uint32_t next = append_edge(tip + i + 1, tip);
    append_triangle({tip, tip + i, tip + i + 1}, {ray, chord, next}, is_hole, vertices, trapezoids);
    ray = next;
  }
}

}  // namespace trapeze
