#include "core/borders/merging.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

#include "core/grid/disjoint_sets.h"
#include "core/grid/tolerance.h"

namespace trapeze {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr FaceId kNoPiece = kOutside;

/// The face on the side of a wall that is not void. A piece of an edge may lead up where the edge
/// leads down, because its ends are rounded.
FaceId face_behind(const VoidMesh& mesh, const TrapezoidalGraph& graph, VoidMesh::HalfEdge wall) {
  const Edge& edge = graph.edge(mesh.edge_of(wall));
  return edge.face[kLeft] == kOutside ? edge.face[kRight] : edge.face[kLeft];
}

/// The class of the polygons at each vertex.
std::vector<std::uint32_t> classes_at_vertices(const VoidMesh& mesh, const TrapezoidalGraph& graph,
                                               std::span<const std::uint32_t> class_of_face) {
  constexpr std::uint32_t kUnset = kMixedClass - 1;
  std::vector<std::uint32_t> classes(mesh.vertex_count(), kUnset);
  for (const VoidMesh::HalfEdge wall : mesh.walls()) {
    const std::uint32_t own = class_of_face[face_behind(mesh, graph, wall)];
    for (const VoidMesh::HalfEdge h : {wall, VoidMesh::next(wall)}) {
      std::uint32_t& known = classes[mesh.vertex(h).value];
      known = known == kUnset || known == own ? own : kMixedClass;
    }
  }
  return classes;
}

/// The distance that a triangle bridges by itself.
double own_distance(const VoidMesh& mesh, std::uint32_t triangle) {
  double narrowest = kNever;
  std::array<double, 3> sides{};
  for (std::uint32_t i = 0; i < 3; ++i) {
    const VoidMesh::HalfEdge h = 3 * triangle + i;
    sides[i] = mesh.length(h);
    if (mesh.is_wall(h)) narrowest = std::min(narrowest, mesh.distance_across(h));
  }
  if (narrowest < kNever) return narrowest;
  std::sort(sides.begin(), sides.end());
  return sides[1];
}

/// The shortest sides that connect all polygons of a class that are near enough, as a minimum
/// spanning tree.
std::vector<VoidMesh::HalfEdge> shortest_bridges(const VoidMesh& mesh,
                                                 const TrapezoidalGraph& graph,
                                                 std::span<const std::uint32_t> class_of_face) {
  const std::vector<std::uint32_t> classes = classes_at_vertices(mesh, graph, class_of_face);
  const auto vertices = static_cast<std::uint32_t>(mesh.vertex_count());
  // Sets of vertices and of the faces of polygons.
  DisjointSets ties(vertices + class_of_face.size());
  for (const VoidMesh::HalfEdge wall : mesh.walls()) {
    for (const VoidMesh::HalfEdge h : {wall, VoidMesh::next(wall)}) {
      ties.tie(mesh.vertex(h).value, vertices + face_behind(mesh, graph, wall));
    }
  }
  std::vector<std::pair<double, VoidMesh::HalfEdge>> sides;
  for (VoidMesh::HalfEdge h = 0; h < 3 * mesh.triangle_count(); ++h) {
    if (mesh.is_wall(h) || mesh.twin(h) < h) continue;
    const std::uint32_t a = mesh.vertex(h).value;
    const std::uint32_t b = mesh.vertex(VoidMesh::next(h)).value;
    if (a == 0 || b == 0 || classes[a] != classes[b] || classes[a] == kMixedClass) continue;
    if (ties.find(a) != ties.find(b)) sides.emplace_back(mesh.length(h), h);
  }
  std::sort(sides.begin(), sides.end());
  std::vector<VoidMesh::HalfEdge> bridges;
  for (const auto& [length, h] : sides) {
    if (length > kWidestBridge) break;
    const std::uint32_t a = ties.find(mesh.vertex(h).value);
    const std::uint32_t b = ties.find(mesh.vertex(VoidMesh::next(h)).value);
    if (a == b) continue;
    ties.tie(a, b);
    bridges.push_back(h);
  }
  return bridges;
}

/// Whether the area beyond a side is filled at a distance together with the area on this side,
/// regardless of anything more than `others` triangles away.
bool is_filled_beyond(const VoidMesh& mesh, VoidMesh::HalfEdge side, double distance, int others) {
  const VoidMesh::HalfEdge first = mesh.twin(side);
  const std::uint32_t triangle = VoidMesh::triangle_of(first);
  if (mesh.is_beyond(triangle) || own_distance(mesh, triangle) > distance) return false;
  const std::array sides{VoidMesh::next(first), VoidMesh::before(first)};
  return std::ranges::all_of(sides, [&](VoidMesh::HalfEdge h) {
    return mesh.is_wall(h) || mesh.length(h) <= distance ||
           (others > 0 && is_filled_beyond(mesh, h, distance, others - 1));
  });
}

bool is_filled_near(const VoidMesh& mesh, std::uint32_t triangle, double distance) {
  constexpr int kOthers = 3;
  if (mesh.is_beyond(triangle) || own_distance(mesh, triangle) > distance) return false;
  for (VoidMesh::HalfEdge h = 3 * triangle; h < 3 * triangle + 3; ++h) {
    if (mesh.is_wall(h) || mesh.length(h) <= distance) continue;
    if (!is_filled_beyond(mesh, h, distance, kOthers)) return false;
  }
  return true;
}

/// Whether the area filled at a distance hardly greater than the length of the bridge reaches walls
/// at both of its ends.
bool is_built(const VoidMesh& mesh, VoidMesh::HalfEdge h) {
  const double distance = VoidMesh::kSlack * mesh.length(h) + 1;  // ends are rounded
  const auto is_filled = [&](std::uint32_t triangle) {
    return is_filled_near(mesh, triangle, distance);
  };
  const auto reaches_wall = [&](VoidMesh::HalfEdge from) {
    return mesh.wall_before(from, is_filled) || mesh.wall_after(from, is_filled);
  };
  return reaches_wall(h) && reaches_wall(mesh.twin(h));
}

/// Numbers the pieces from first_void on.
class Pieces {
 public:
  Pieces(const VoidMesh& mesh, const std::vector<double>& distances, double ratio,
         FaceId first_void) {
    const auto count = static_cast<std::uint32_t>(mesh.triangle_count());
    std::vector<int> levels(count, kLastLevel + 1);
    for (std::uint32_t t = 0; t < count; ++t) {
      if (distances[t] <= kWidestBridge) levels[t] = level_above(distances[t] / ratio);
    }
    DisjointSets ties(count);
    for (VoidMesh::HalfEdge h = 0; h < 3 * count; ++h) {
      if (mesh.is_wall(h)) continue;
      const std::uint32_t t = VoidMesh::triangle_of(h);
      const std::uint32_t beyond = VoidMesh::triangle_of(mesh.twin(h));
      if (levels[t] == levels[beyond]) ties.tie(t, beyond);
    }
    faces_.assign(count, kNoPiece);
    for (std::uint32_t t = 0; t < count; ++t) {
      if (levels[t] > kLastLevel) continue;
      FaceId& face = faces_[ties.find(t)];
      if (face == kNoPiece) {
        face = first_void + static_cast<FaceId>(due_.size());
        due_.push_back(0);
        firsts_.push_back(t);
      }
      faces_[t] = face;
      double& due = due_[face - first_void];
      due = std::max(due, distances[t] / ratio);
    }
  }

  FaceId face_of(std::uint32_t triangle) const { return faces_[triangle]; }
  const std::vector<double>& due() const { return due_; }
  /// One triangle of each piece.
  const std::vector<std::uint32_t>& firsts() const { return firsts_; }

 private:
  std::vector<FaceId> faces_;  // by triangle
  std::vector<double> due_;
  std::vector<std::uint32_t> firsts_;
};

void add_segment(Point a, Point b, FaceId right_of_ab, FaceId left_of_ab, DividedVoid& divided) {
  if (is_above(a, b)) {
    divided.segments.emplace_back(a, b);
    divided.sides.emplace_back(right_of_ab, left_of_ab);  // the right side of a segment that goes
  } else {                                                // down is on the left of the map
    divided.segments.emplace_back(b, a);
    divided.sides.emplace_back(left_of_ab, right_of_ab);
  }
}

/// Whether two faces of one class share an edge.
bool do_faces_touch(const TrapezoidalGraph& graph, const MergePlan& plan) {
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const Edge& edge = graph.edge(EdgeId(i));
    const bool is_between =
        !graph.is_frame(EdgeId(i)) && edge.face[kLeft] != kOutside && edge.face[kRight] != kOutside;
    if (is_between && plan.are_of_one_class(edge.face[kLeft], edge.face[kRight])) return true;
  }
  return false;
}

}  // namespace

// The largest set is what remains after everything else has been removed, from the greatest
// distance down. A triangle is removed at its own distance. If a neighbour has been removed and the
// side between them is longer, it is removed at the smaller of the two distances. Triangles that
// are too wide are removed first, in any order.
std::vector<double> distances_to_fill(const VoidMesh& mesh, const TrapezoidalGraph& graph,
                                      std::span<const std::uint32_t> class_of_face) {
  const std::vector<std::uint32_t> classes = classes_at_vertices(mesh, graph, class_of_face);
  const auto count = static_cast<std::uint32_t>(mesh.triangle_count());
  std::vector<double> distances(count);
  std::vector<bool> is_known(count, false);
  // Distances that are not raised stay in order; the few raised ones wait in a separate queue.
  std::vector<std::pair<double, std::uint32_t>> order;
  std::priority_queue<std::pair<double, std::uint32_t>> raised;
  std::vector<std::uint32_t> beyond_all;
  for (std::uint32_t t = 0; t < count; ++t) {
    const auto class_at = [&](std::uint32_t i) { return classes[mesh.vertex(3 * t + i).value]; };
    const bool is_between_equals = !mesh.is_beyond(t) && class_at(0) != kMixedClass &&
                                   class_at(0) == class_at(1) && class_at(0) == class_at(2);
    distances[t] = is_between_equals ? own_distance(mesh, t) : kNever;
    if (distances[t] > kWidestBridge) {
      beyond_all.push_back(t);
    } else {
      order.emplace_back(distances[t], t);
    }
  }
  const auto take_away = [&](std::uint32_t t) {
    is_known[t] = true;
    for (std::uint32_t side = 0; side < 3; ++side) {
      const VoidMesh::HalfEdge h = 3 * t + side;
      if (mesh.is_wall(h)) continue;
      const std::uint32_t next = VoidMesh::triangle_of(mesh.twin(h));
      if (is_known[next] || distances[next] > kWidestBridge) continue;
      const double at_least = std::min(distances[t], mesh.length(h));
      if (at_least <= distances[next]) continue;
      distances[next] = at_least;
      if (at_least > kWidestBridge) {
        beyond_all.push_back(next);
      } else {
        raised.emplace(at_least, next);
      }
    }
  };
  while (!beyond_all.empty()) {
    const std::uint32_t t = beyond_all.back();
    beyond_all.pop_back();
    take_away(t);
  }
  std::sort(order.begin(), order.end(), std::greater<>());
  for (std::size_t i = 0; i < order.size() || !raised.empty();) {
    const bool is_raised = !raised.empty() && (i == order.size() || order[i] < raised.top());
    const std::uint32_t t = is_raised ? raised.top().second : order[i].second;
    if (is_raised) {
      raised.pop();
    } else {
      ++i;
    }
    if (!is_known[t]) take_away(t);
  }
  return distances;
}

void divide_walls_for_bridges(VoidMesh& mesh, const TrapezoidalGraph& graph,
                              std::span<const std::uint32_t> class_of_face) {
  mesh.divide_walls(kWidestBridge);
  if (mesh.has_failed()) return;
  std::vector<VoidMesh::HalfEdge> bridges = shortest_bridges(mesh, graph, class_of_face);
  std::erase_if(bridges, [&](VoidMesh::HalfEdge h) { return is_built(mesh, h); });
  mesh.divide_walls_beside(bridges);
}

std::optional<DividedVoid> divide_void(const TrapezoidalGraph& graph, double ratio,
                                       FaceId first_void,
                                       std::span<const std::uint32_t> class_of_face) {
  VoidMesh mesh(graph);
  if (!mesh.has_failed()) divide_walls_for_bridges(mesh, graph, class_of_face);
  if (mesh.has_failed()) return std::nullopt;
  const Pieces pieces(mesh, distances_to_fill(mesh, graph, class_of_face), ratio, first_void);

  DividedVoid divided;
  MergePlan& plan = divided.plan;
  plan.ratio = ratio;
  plan.first_void = first_void;
  plan.due = pieces.due();
  plan.classes.assign(class_of_face.begin() + 1, class_of_face.end());
  if (plan.due.empty()) {
    if (!do_faces_touch(graph, plan)) return std::nullopt;
    return divided;
  }
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const Edge& edge = graph.edge(EdgeId(i));
    if (graph.is_frame(EdgeId(i)) || edge.face[kLeft] == kOutside ||
        edge.face[kRight] == kOutside) {
      continue;
    }
    divided.segments.emplace_back(graph.point(edge.end[kUp]), graph.point(edge.end[kDown]));
    divided.sides.emplace_back(edge.face[kLeft], edge.face[kRight]);
  }
  for (const VoidMesh::HalfEdge wall : mesh.walls()) {
    add_segment(mesh.corner(wall), mesh.corner(VoidMesh::next(wall)),
                pieces.face_of(VoidMesh::triangle_of(wall)), face_behind(mesh, graph, wall),
                divided);
  }
  for (VoidMesh::HalfEdge h = 0; h < 3 * mesh.triangle_count(); ++h) {
    if (mesh.is_wall(h) || mesh.twin(h) < h) continue;
    const FaceId here = pieces.face_of(VoidMesh::triangle_of(h));
    const FaceId beyond = pieces.face_of(VoidMesh::triangle_of(mesh.twin(h)));
    if (here == beyond) continue;
    add_segment(mesh.corner(h), mesh.corner(VoidMesh::next(h)), here, beyond, divided);
  }

  const std::vector<std::uint32_t> classes = classes_at_vertices(mesh, graph, class_of_face);
  for (const std::uint32_t t : pieces.firsts())
    plan.classes.push_back(classes[mesh.vertex(3 * t).value]);
  return divided;
}

}  // namespace trapeze
