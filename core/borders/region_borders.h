// Dissolves the small regions of a coverage: a region too small to see becomes a part of a
// neighbour.
//
// Removing only vertices would leave every region at least a triangle and every junction in its
// place. So a region whose mean width is below a limit set by the tolerance becomes a part of the
// face, other than the outside, with which it has the longest border. That border is removed edge
// by edge, which cannot make boundaries cross; the rest of the region's border becomes the
// neighbour's. Junctions left with only two arcs become corners of one arc.
//
// With a plan of blocks (see merging.h), pieces of the void are regions as well. A piece that is
// due becomes a part of the polygons on its sides, and these become one region:
//
//     +-----+.....+-----+           +-----------------+
//     |  A  : void:  B  |           |        A        |    the larger of the two gives its face
//     +-----+.....+-----+           +-----------------+
//
// A piece that bridges nothing by itself waits for the next piece beside it. If there is none,
// because the polygons it bridged have become too small to see, it is void like its surroundings.
// Polygons that touch become one region when the narrower one is narrower than the distance that is
// bridged.
//
// Must be informed of every removal from the graph; follows removals forwards only. Thread-safety:
// none.
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
#include "core/mesh/outline.h"

namespace trapeze {

/// An area that was transferred, wholly or in part, from one face to another. A rectangle of that
/// area with this axis represents its place.
struct Taken {
  Axis axis;
  double area = 0;          // cells squared, of the original region
  FaceId face = kOutside;   // the former face
  FaceId taker = kOutside;  // the face that covers it now
};

/// One of the edges of a loop, the side of it on which the inside is, and the faces before the
/// removal.
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
  /// when it is half a pixel wide and the tolerance is a quarter of a pixel. Infinite if it is not
  /// removed as a region: it no longer exists, is the unbounded one, or has no junction, so that
  /// its loops are removed vertex by vertex.
  double weight(RegionId region);

  /// The regions that became one, which has the number of the first of them.
  using United = std::vector<RegionId>;
  /// Merges a region of finite weight into a neighbour, as one new edit. Returns none, and makes no
  /// edit, if it has no neighbour that could take it.
  United remove(RegionId region, EditLog& log);
  /// Whether there is a plan by which regions become blocks.
  bool has_plan() const { return plan_ != nullptr; }

  /// Call after a corner has been removed other than with its loop. Of its two edges, `gone` no
  /// longer exists, and `kept` leaves `corner`.
  void note_joined(EdgeId gone, EdgeId kept, CornerId corner);
  /// Call when a triangular loop is removed: the region inside becomes a part of the one outside.
  void note_lost_loop(const LostLoop& loop);

  /// Prefetches, step by step, the memory that weight() and remove() will read for a region (see
  /// fetch_ahead.h). Changes nothing.
  enum class FetchStep { region, seeds, edges, corners };
  void fetch(FetchStep step, RegionId region) const;

  // Effects of the last removal.
  /// Areas transferred from one face to another.
  std::span<const Taken> taken() const { return taken_; }
  /// Size of the loop around the resulting block; none if no block resulted.
  std::optional<LoopSize> block_size() const { return block_size_; }
  /// All edges of the resulting block, if its extent has grown by a quarter; if empty, edges whose
  /// face has not changed know its size, or almost.
  std::span<const EdgeId> block_edges() const { return block_edges_; }
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
  // The data of an edge, stored together because they are always needed together.
  struct Border {
    std::array<RegionId, 2> beside;
    EdgeId replaced_by;
    CornerId corner;  // the corner that the edge leaves
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
  LoopSize size_of(RegionId region) const;
  void note_block(RegionId block);
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
  Table<RegionId, AreaMoments> moments_;  // of the original regions
  Table<RegionId, List> lists_;
  Table<RegionId, std::uint8_t> may_have_junction_;
  // With a plan: the size of the loop, as known to all edges of the region.
  Table<RegionId, LoopSize> known_sizes_;
  std::vector<Seed> seeds_;
  RegionId unbounded_;
  std::vector<CornerId> ends_;                // of arcs, in order of their vertices
  Table<VertexId, std::uint32_t> first_end_;  // by vertex; index into ends_

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
  std::optional<LoopSize> block_size_;
  std::vector<EdgeId> block_edges_;
  std::vector<VertexId> changed_;
  std::vector<CornerId> dissolved_;
};

}  // namespace trapeze
