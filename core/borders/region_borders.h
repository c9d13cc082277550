// Dissolves the small regions of a coverage: a region too small to see becomes a part of a
// neighbour.
//
// Removing vertices alone would leave every region at least a triangle and every junction in its
// place. So a region whose mean width is below a limit set by the tolerance becomes a part of that
// face, other than the outside, with which it has the longest border. That border is removed edge
// by edge, which cannot make boundaries cross; the rest of the region's border becomes the
// neighbour's. Junctions where only two arcs are left become corners of one arc.
//
// With a plan of blocks (see merging.h), pieces of the void are regions as well. One that is due
// becomes a part of the polygons that it lies between, and these become one region:
//
//     +-----+.....+-----+           +-----------------+
//     |  A  : void:  B  |           |        A        |    the larger of the two gives its face
//     +-----+.....+-----+           +-----------------+
//
// If it bridges nothing by itself, it waits for the next piece beside it; if there is none, as what
// it bridged has become too small to see, it is void like all around. Polygons that touch become
// one region when the narrower one is narrower than the distance that is bridged.
//
// Must be told of every removal from the graph, and follows them forward only. Thread-safety: none.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/borders/border_arcs.h"
#include "core/borders/merge_plan.h"
#include "core/borders/regions.h"
#include "core/graph/edit_log.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/grid/area_moments.h"
#include "core/grid/grid.h"

namespace trapeze {

/// An area that went from one face to another, or a part of it: a rectangle of that area, with this
/// axis, stands for the place where it was.
struct Taken {
  Axis axis;
  double area = 0;          // cells squared, of the region as it was at first
  FaceId face = kOutside;   // what it was
  FaceId taker = kOutside;  // what covers it now
};

/// One of the edges of a loop, on which side of it the inside is, and the faces as they were.
struct LostLoop {
  EdgeId edge;
  Side side = kLeft;
  FaceId inside = kOutside;
  FaceId outside = kOutside;
};

class RegionBorders {
 public:
  /// `graph`, a coverage, must outlive the use of this object; so must `plan`, if it is not null.
  void assign(const TrapezoidalGraph& graph, const MergePlan* plan = nullptr);

  /// Regions are numbered 0 .. count() - 1; one that has become a part of another no longer exists.
  std::size_t count() const { return parent_.size(); }

  /// The tolerance at which the region is to be removed, in cells: such that a square is removed
  /// when it is half a pixel wide and the tolerance a quarter of a pixel. Infinite if it is not
  /// removed as a region: it no longer exists, is the unbounded one, or has no junction, so that
  /// its loops are removed vertex by vertex.
  double weight(RegionId region);

  /// The regions that are one from then on, under the number of the first of them.
  using United = std::vector<RegionId>;
  /// Makes a region of finite weight a part of a neighbour, as one new edit. None, and no edit, if
  /// it has no neighbour of which it could become a part.
  United remove(RegionId region, EditLog& log);
  /// Whether there is a plan by which regions become blocks.
  bool has_plan() const { return plan_ != nullptr; }

  /// To be called after a corner has been removed other than with its loop: of its two edges,
  /// `gone` no longer exists, and `kept` leaves `corner`.
  void note_joined(EdgeId gone, EdgeId kept, CornerId corner);
  /// To be called when a triangular loop is removed: the region inside becomes a part of the one
  /// outside.
  void note_lost_loop(const LostLoop& loop);

  /// Prefetches, step by step, what weight() and remove() will read of a region (see
  /// fetch_ahead.h). They change nothing.
  enum class FetchStep { region, seeds, edges, corners };
  void fetch(FetchStep step, RegionId region) const;

  // What the last removal did.
  /// Areas that went from one face to another.
  std::span<const Taken> taken() const { return taken_; }
  /// Of the block that came about, in cells squared; none if it was none.
  std::optional<double> block_area() const { return block_area_; }
  /// Vertices that lost an edge.
  std::span<const VertexId> changed() const { return changed_; }
  /// Junctions that have become corners in the middle of an arc.
  std::span<const CornerId> dissolved() const { return dissolved_; }

 private:
  // Every arc is in the lists of the two regions beside it, identified by one of its original
  // edges.
  static constexpr std::uint32_t kNobody = 0xffffffff;
  struct Seed {
    EdgeId edge;
    std::uint32_t next = kNobody;
  };
  struct List {
    std::uint32_t first = kNobody;
    std::uint32_t last = kNobody;
  };
  // Of an edge: together, as whoever needs one of them needs the others.
  struct Border {
    std::array<RegionId, 2> beside;
    EdgeId replaced_by;
    CornerId corner;  // that the edge leaves
    std::uint32_t seen = 0;
  };

  // An arc of the current region, as edges_[begin .. end).
  struct Arc {
    std::size_t begin = 0;
    std::size_t end = 0;
    CornerId first;
    bool is_closed = false;
    FaceId beyond = kOutside;  // the face on its other side
  };

  RegionId find(RegionId region);
  EdgeId find(EdgeId edge);
  void unite(RegionId a, RegionId b);
  void collect_seeds();

  void collect_arcs(RegionId region);
  Arc walk_arc(EdgeId edge);
  /// A region of the same class beyond an arc of the current one.
  struct Mate {
    RegionId region;
    FaceId face = kOutside;
    double border = 0;  // its length
  };

  FaceId choose_taker(FaceId face) const;
  FaceId find_later_piece(FaceId face) const;
  double length_of_arc(const Arc& arc) const;
  std::vector<Mate> mates_of(RegionId region, FaceId face);
  bool bridges(std::size_t mates) const;
  bool is_smaller(RegionId a, RegionId b) const;
  void join(RegionId region, FaceId face, const Mate& mate, EditLog& log, United& united);
  void dissolve(RegionId region, FaceId taker, EditLog& log, United& united);
  Side side_of(EdgeId edge, RegionId region);
  void measure_regions(const Regions& regions);
  void note_taken(RegionId region, FaceId face, FaceId taker);
  void note_pieces(RegionId region, FaceId face, FaceId taker);
  void fetch_ends(std::span<const VertexId> junctions) const;
  std::span<const CornerId> ends_at(VertexId v) const;
  void repair_junction(VertexId v, EditLog& log);
  void join_ends(CornerId a, CornerId b, EditLog& log);
  void reverse(CornerId end, EditLog& log);
  CornerId end_at(VertexId v, EdgeId edge) const;

  const TrapezoidalGraph* graph_ = nullptr;
  const MergePlan* plan_ = nullptr;
  Table<EdgeId, Border> borders_;
  Table<RegionId, RegionId> parent_;
  Table<RegionId, FaceId> faces_;
  Table<RegionId, AreaMoments> moments_;  // as they were at first
  Table<RegionId, List> lists_;
  Table<RegionId, std::uint8_t> may_have_junction_;
  std::vector<Seed> seeds_;
  RegionId unbounded_;
  std::vector<CornerId> ends_;                // of arcs, in order of their vertices
  Table<VertexId, std::uint32_t> first_end_;  // by vertex, in ends_

  // Of the current region.
  std::uint32_t stamp_ = 0;
  std::vector<Arc> arcs_;
  std::vector<EdgeId> edges_;
  Box box_;
  bool has_junction_ = false;
  std::vector<Spoke> spokes_;
  std::vector<VertexId> junctions_;
  std::vector<CornerId> gone_corners_;
  std::vector<Taken> taken_;
  std::optional<double> block_area_;
  std::vector<VertexId> changed_;
  std::vector<CornerId> dissolved_;
};

}  // namespace trapeze
