// What is narrower than a width is drawn that wide: the strips by which faces grow (the paper's
// Figure 10b, and 10a where two of them meet).
//
// From places p along the boundary of a face, three lengths are told:
//
//   width      how far it is from p, straight into the face, to its opposite side; but not less
//              than the diameter of a disc within the face beside p, so that corners of what is
//              wide are not taken for narrow;
//   growth     half of what the width lacks. There the boundary moves outwards by that, and
//              corners remain corners;
//   reserve    of what is wide enough: half of what a disc within it beside p has more than the
//              width asked for. So far others may grow over the face at p.
//
//        |      :          |             a, narrow here, grows by the same on both sides, up to
//        |  a   :<- growth |   b         the dotted line; between a and b, which grows towards it,
//        |      :          |             neither goes beyond the middle of the void if both would.
//
// Towards the boundary of another face, or of another part of the same one, p moves along its
// normal at most until it is as near to that boundary as to p: into the disc that touches p and the
// other boundary no second normal of that kind comes. Where the other does not want to grow so far,
// it may move as much farther, and where the other has a reserve, over it as far as that goes. So
// no two strips overlap, and none covers what is itself too narrow; see "Exaggeration" in
// core/README.md.
//
// What grows, and how, does not depend on what else has been added, as long as there is everything
// within reach_of() of it.
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
    double width = 0;  // to which faces grow, in pixels
    double pixel = 1;  // cells
  };

  /// How far around a place the boundary has to be known; both in pixels.
  static constexpr double reach_of(double width) { return 8 * width + 8; }

  /// Three points around a place that belongs to the face as well.
  struct Triangle {
    BoundaryMap::Face face = BoundaryMap::kNoFace;
    std::array<Point, 3> corners;   // the uppermost first
    bool is_beside_others = false;  // whether it may have places in common with other faces
  };

  /// To be filled before find().
  BoundaryMap& boundary() { return boundary_; }
  const BoundaryMap& boundary() const { return boundary_; }

  /// Finds what grows into the box. Throws Cancelled.
  void find(const Size& size, const Box& box, const Cancellation* cancellation);

  /// Leaves out what grows of faces for which is_kept(face) is false.
  template <typename IsKept>
  void keep(const IsKept& is_kept);

  /// Without places in common, nor any in common with the face that they belong to.
  std::span<const Triangle> triangles() const { return triangles_; }

  /// The way of an edge of a piece, moved, from its upper end to its lower one. Replaces `way`.
  void trace(std::uint32_t piece, const MeshView& mesh, std::uint32_t edge,
             std::vector<PlateCarreeMesh::PointOnWay>& way) const;

  /// Appends, with negative area, what the triangles have in common with the trapezoid.
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
  // A place on the boundary of a face. What is not known yet is less than 0, or kNone.
  struct Sample {
    float ray = -1;    // or -2: not less than the width
    float facing = 0;  // from 0 to 1: whether that meets the opposite side of the face
    float growth = -1;
    float reserve = -1;
    // Of discs_: within the face, a smaller and a larger one.
    std::array<std::uint32_t, 2> discs{BoundaryMap::kNone, BoundaryMap::kNone};
  };
  // Of an edge: so many steps, and samples of those in the box.
  struct Row {
    Vector normal;           // of length 1, into the face of the even side
    std::int32_t steps = 0;  // 0: no sample
    std::int32_t first = 0;
    std::int32_t count = 0;
    std::uint32_t sample = BoundaryMap::kNone;  // of the first, on both sides in turn; once needed
  };
  // A boundary of few edges around a face.
  struct Loop {
    std::uint32_t side = 0;  // one of it
    // What lies in the box around it, of loop_edges_, if that is not too much.
    Vector min;
    Vector max;
    std::uint32_t first_edge = 0;
    std::uint32_t edge_count = 0;
    // Its places, in order, of loop_places_ and loop_order_; once needed, if it is short.
    bool is_short = false;
    double around = 0;  // how long it is
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  // By how much the boundary turns from one side to the next, towards the face.
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
    double most = 0;     // of the radius of the smaller disc, known without looking
    double radius = -1;  // once needed
    double along = 0;    // how far from the first one
  };
  // A place that moves: how far from the upper end, as a share of the edge, and how far outwards.
  struct Moved {
    double share = 0;
    double by = 0;
    bool is_folded = false;  // the end of an edge, where this side and the next leave no room
  };
  struct MovedSide {
    std::uint32_t side = 0;
    std::uint32_t first = 0;  // of moved_
    std::uint32_t count = 0;
  };
  struct Tip {
    std::uint32_t side = 0;  // the one that ends there, so that the next begins there
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
  Box around_box_;         // where what moves may come into the box
  std::vector<Row> rows_;  // by edge
  std::vector<Sample> samples_;
  std::vector<Vector> places_;  // of the samples of both sides
  std::vector<Disc> discs_;
  std::vector<std::uint32_t> loop_of_side_;   // kNone: not known; kLong, see find_loop()
  std::vector<std::uint32_t> place_of_side_;  // if it is of a loop: of the first one, in its order
  std::vector<Loop> loops_;
  std::vector<BoundaryMap::Near> loop_edges_;
  std::vector<LoopPlace> loop_places_;
  std::vector<std::uint32_t> loop_order_;  // of loop_places_: the largest `most` first
  std::vector<Moved> moved_;
  std::vector<MovedSide> moved_sides_;          // by side
  std::vector<std::uint32_t> number_of_moved_;  // of moved_sides_, by side, or kNone
  std::vector<Tip> tips_;                       // by side
  std::vector<Triangle> triangles_;  // those beside others last, by their uppermost corners
  std::vector<Triangle> beside_others_;
  std::int32_t highest_ = 0;  // of those beside others, in cells
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
