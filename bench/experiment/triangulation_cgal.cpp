#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>

#include "bench/experiment/beyond_view.h"
#include "bench/experiment/trapezoid_list.h"
#include "bench/experiment/triangulation.h"

namespace trapeze::experiment {
namespace {

enum class Place : std::uint8_t { unknown, outside, inside };

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<Place, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using DataStructure =
    CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_2<Kernel>, FaceBase>;
using Cdt =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, DataStructure, CGAL::Exact_predicates_tag>;

Point grid_point(const Kernel::Point_2& p) {
  return {static_cast<std::int32_t>(p.x()), static_cast<std::int32_t>(p.y())};
}

}  // namespace

struct Triangulation::State {
  Cdt cdt;
  Rings rings;
  std::vector<Kernel::Point_2> points;
  std::vector<Cdt::Face_handle> pending;

  void find_inside() {
    for (auto face = cdt.all_faces_begin(); face != cdt.all_faces_end(); ++face) {
      face->info() = Place::unknown;
    }
    pending.assign(1, cdt.infinite_face());
    cdt.infinite_face()->info() = Place::outside;
    while (!pending.empty()) {
      const Cdt::Face_handle face = pending.back();
      pending.pop_back();
      for (int i = 0; i < 3; ++i) {
        const Cdt::Face_handle next = face->neighbor(i);
        if (next->info() != Place::unknown) continue;
        const bool is_inside = (face->info() == Place::inside) != face->is_constrained(i);
        next->info() = is_inside ? Place::inside : Place::outside;
        pending.push_back(next);
      }
    }
  }
};

bool has_triangulation() {
  return true;
}

Triangulation::Triangulation() : state_(std::make_unique<State>()) {}
Triangulation::~Triangulation() = default;

void Triangulation::triangulate(const Rings& rings, std::uint32_t first, std::uint32_t last,
                                const Box& view, TrapezoidList& trapezoids) {
  if (last - first == 1 && rings[first].size() == 3) {
    const auto ring = rings[first];
    trapezoids.append_triangle({ring[0], ring[1], ring[2]}, view);
    return;
  }
  State& state = *state_;
  state.cdt.clear();
  state.rings.clear();
  append_with_short_cuts(rings, first, last, view, state.rings);
  for (std::size_t r = 0; r < state.rings.size(); ++r) {
    state.points.clear();
    for (const Point p : state.rings[r]) state.points.emplace_back(p.x, p.y);
    state.cdt.insert_constraint(state.points.begin(), state.points.end(), true);
  }
  if (state.cdt.dimension() < 2) return;  // after the short cuts, only a line is left
  state.find_inside();
  for (const auto face : state.cdt.finite_face_handles()) {
    if (face->info() != Place::inside) continue;
    const std::array<Point, 3> corners{grid_point(face->vertex(0)->point()),
                                       grid_point(face->vertex(1)->point()),
                                       grid_point(face->vertex(2)->point())};
    trapezoids.append_triangle(corners, view);
  }
}

}  // namespace trapeze::experiment
