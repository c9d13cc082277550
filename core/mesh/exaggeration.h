// Draws features narrower than a given width at that width: the strips by which faces grow (the
// paper's Figure 10b, and 10a where two of them meet).
//
// Three lengths are computed at points p along the boundary of a face:
//
//   width      the distance from p, straight into the face, to its opposite side; but at least
//              the diameter of a disc within the face beside p, so that corners of wide features
//              do not count as narrow;
//   growth     half of what the width lacks. The boundary there moves outwards by that much, and
//              corners remain corners;
//   reserve    where the face is wide enough: half of the excess of the diameter of a disc
//              within it beside p over the requested width. Others may grow over the face at p
//              by so much.
//
//        |      :          |             a, narrow here, grows by the same on both sides, up to
//        |  a   :<- growth |   b         the dotted line. Between a and b, which grows towards it,
//        |      :          |             neither passes the middle of the void if both want to.
//
// Towards the boundary of another face, or of another part of the same one, p moves along its
// normal at most until it is as near to that boundary as to p: no second normal of that kind enters
// the disc that touches p and the other boundary. If the other boundary needs less room, p may move
// farther by the rest; if the other has a reserve, p may move over it by that much. So no two
// strips overlap, and none covers a feature that is itself too narrow; see "Growth" in
// core/README.md.
//
// What grows, and how, does not depend on what else has been added, provided that everything within
// reach_of() of it has been.
//
// Thread-safety: one thread at a time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/grid/cancellation.h"
#include "core/grid/grid.h"
#include "core/mesh/boundary_map.h"
#include "core/mesh/plate_carree_mesh.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

class Exaggeration {
 public:
  struct Size {
    double width = 0;  // the width to which faces grow, in pixels
    double pixel = 1;  // cells
  };

  /// How far around a place the boundary must be known. Both in pixels.
  static constexpr double reach_of(double width) { return 8 * width + 8; }

  /// A triangle around additional area of the face.
  struct Triangle {
    BoundaryMap::Face face = BoundaryMap::kNoFace;
    std::array<Point, 3> corners;   // the uppermost one first
    bool is_beside_others = false;  // whether it may overlap other faces
  };

  /// To be filled before find().
  BoundaryMap& boundary() { return boundary_; }
  const BoundaryMap& boundary() const { return boundary_; }

  /// Finds the growth that reaches into the box. Throws Cancelled.
  void find(const Size& size, const Box& box, const Cancellation* cancellation);

  /// Drops the growth of faces for which is_kept(face) is false.
  template <typename IsKept>
  void keep(const IsKept& is_kept);

  /// The triangles overlap neither each other nor the face that they belong to.
  std::span<const Triangle> triangles() const { return triangles_; }

  /// Replaces `way` by the moved path of an edge of a piece, from its upper end to its lower one.
  void trace(std::uint32_t piece, const MeshView& mesh, std::uint32_t edge,
             std::vector<PlateCarreeMesh::PointOnWay>& way) const;

  /// Appends, with negative area, the intersection of the triangles with the trapezoid.
  void append_common(const MeshView& mesh, const MeshTrapezoid& trapezoid,
                     std::vector<Point>& vertices, std::vector<MeshEdge>& edges,
                     std::vector<MeshTrapezoid>& trapezoids) const;
  /// Appends the triangle.
  static void append(const Triangle& triangle, std::vector<Point>& vertices,
                     std::vector<MeshEdge>& edges, std::vector<MeshTrapezoid>& trapezoids);

 private:
  struct Disc {
    Vector middle;
    double radius = -1;
  };
  // A point on the boundary of a face. Values not computed yet are negative, or kNone.
  struct Sample {
    float ray = -1;    // or -2: at least the width
    float facing = 0;  // from 0 to 1: how far the boundary that the ray meets is the opposite side
                       // of the face
    float growth = -1;
    float reserve = -1;
    // Indices in discs_ of a smaller and a larger disc within the face.
    std::array<std::uint32_t, 2> discs{BoundaryMap::kNone, BoundaryMap::kNone};
  };
  // The number of steps of an edge, and its samples in the box.
  struct Row {
    Vector normal;           // of length 1, into the face of the even side
    std::int32_t steps = 0;  // 0: no sample
    std::int32_t first = 0;
    std::int32_t count = 0;
    std::uint32_t sample = BoundaryMap::kNone;  // index of the first sample, both sides
                                                // alternating; once needed
  };
  // A boundary of few edges around a face.
  struct Loop {
    std::uint32_t side = 0;  // one of its sides
    // The contents of the box around it, in loop_edges_, if they are not too many.
    Vector min;
    Vector max;
    std::uint32_t first_edge = 0;
    std::uint32_t edge_count = 0;
    // Its places, in order, in loop_places_ and loop_order_; once needed, if it is short.
    bool is_short = false;
    double around = 0;  // its length
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  // The angle by which the boundary turns from one side to the next, towards the face.
  struct Turn {
    double sine = 0;
    double cosine = 0;
  };
  struct At {
    std::uint32_t side = 0;
    std::int32_t step = 0;
  };
  struct LoopPlace {
    At at;
    Vector place;
    double most = 0;     // upper bound of the radius of the smaller disc, known without a search
    double radius = -1;  // once needed
    double along = 0;    // distance from the first one along the loop
  };
  // A point that moves: its distance from the upper end as a fraction of the edge, and the distance
  // by which it moves outwards.
  struct Moved {
    double share = 0;
    double by = 0;
    bool is_folded = false;  // the end of an edge where this side and the next leave no room
  };
  struct MovedSide {
    std::uint32_t side = 0;
    std::uint32_t first = 0;  // index in moved_
    std::uint32_t count = 0;
  };
  struct Tip {
    std::uint32_t side = 0;  // the side that ends there; the next one begins there
    Point at;
  };

  void divide_edges(const Box& box);
  bool has_sample(At at) const;
  Sample& sample(At at);
  void take_samples(std::uint32_t edge);
  Vector place(At at);
  Vector inward(std::uint32_t side) const;
  std::optional<At> step_on(At at) const;
  std::optional<At> step_back(At at) const;

  bool is_narrow(At at);
  float ray(At at);
  bool look_across(At at, double share);
  double half_ray(At at, double most);
  Disc disc(At at, std::size_t size);
  double clearance(Vector middle, double most, std::uint32_t loop);
  template <typename Visit>
  void walk_from(At at, double far, const Visit& visit);
  double width_beside(At at);
  std::uint32_t loop_of(std::uint32_t side);
  std::uint32_t find_loop(std::uint32_t side);
  void append_loop(std::uint32_t side);
  void append_edges(Loop& loop);
  void append_places(Loop& loop);
  std::span<const BoundaryMap::Near> edges_in(const Loop& loop) const;
  double widest_in(const Loop& loop, At at);
  double radius_of(LoopPlace& place);
  double thickness(At at);
  double growth(At at);
  double growth_across(At at);
  double reserve(At at);
  double signed_growth(std::uint32_t side, double share);
  double positive_growth(std::uint32_t side, double share);
  template <typename Of>
  double between_steps(std::uint32_t side, double share, const Of& of);

  double limited(Vector from, Vector normal, double by, const std::array<std::uint32_t, 3>& exempt);
  double limited_by_neighbour(std::uint32_t side, double share, double by);
  double growth_at_end(std::uint32_t side, bool is_at_head);
  Vector way_of(std::uint32_t side) const;
  Turn turn_between(std::uint32_t side, std::uint32_t next) const;
  std::optional<std::array<double, 2>> fold_between(std::uint32_t side, std::uint32_t next);
  void move_side(std::uint32_t side);
  void straighten(std::size_t first, std::int32_t steps);
  void append_strip(const MovedSide& moved);
  void append_corner(std::uint32_t side, std::uint32_t next);
  std::optional<Vector> tip_between(std::uint32_t side, std::uint32_t next, double one,
                                    double other);
  double moved_end(std::uint32_t side, bool is_at_head) const;
  Point end_place(std::uint32_t side, bool is_at_head) const;
  const MovedSide* find_moved(std::uint32_t side) const;
  const Tip* find_tip(std::uint32_t side) const;
  Point place_of(std::uint32_t side, const Moved& moved) const;
  static double moved_by(std::span<const Moved> places, double share);
  bool is_beside_others(std::uint32_t side) const;
  void append_triangle(BoundaryMap::Face face, bool is_beside_others,
                       const std::array<Point, 3>& corners);
  void number_moved_sides();
  void sort_triangles();

  BoundaryMap boundary_;
  double width_ = 0;  // cells
  double pixel_ = 1;  // cells
  Box box_;
  Box around_box_;         // growth into the box may start here
  std::vector<Row> rows_;  // by edge
  std::vector<Sample> samples_;
  std::vector<Vector> places_;  // of the samples of both sides
  std::vector<Disc> discs_;
  std::vector<std::uint32_t> loop_of_side_;   // kNone: not known; kLong, see find_loop()
  std::vector<std::uint32_t> place_of_side_;  // if in a loop: its first place, in the order of the
                                              // loop
  std::vector<Loop> loops_;
  std::vector<BoundaryMap::Near> loop_edges_;
  std::vector<LoopPlace> loop_places_;
  std::vector<std::uint32_t> loop_order_;  // of loop_places_: by `most`, the largest first
  std::vector<Moved> moved_;
  std::vector<MovedSide> moved_sides_;          // by side
  std::vector<std::uint32_t> number_of_moved_;  // of moved_sides_, by side, or kNone
  std::vector<Tip> tips_;                       // by side
  std::vector<Triangle> triangles_;  // those beside others last, by their uppermost corners
  std::vector<Triangle> beside_others_;
  std::int32_t highest_ = 0;  // largest height of those beside others, in cells
};

template <typename IsKept>
void Exaggeration::keep(const IsKept& is_kept) {
  std::erase_if(triangles_, [&](const Triangle& one) { return !is_kept(one.face); });
  const auto is_gone = [&](const auto& one) { return !is_kept(boundary_.face_of(one.side)); };
  std::erase_if(moved_sides_, is_gone);
  number_moved_sides();
  std::erase_if(tips_, is_gone);
}

}  // namespace trapeze
