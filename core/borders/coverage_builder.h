// Builds one trapezoidal graph from the rings of several features that share borders.
//
// All rings are noded together (see set_map.h), so a border that two features share occurs once. A
// place covered by several features is a face of its own if it is wide enough to be seen; otherwise
// it belongs to the feature drawn last. Edges that then have the same face on both sides are
// removed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/borders/border_arcs.h"
#include "core/borders/face_features.h"
#include "core/borders/merge_plan.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/grid/rings.h"
#include "core/grid/work_share.h"
#include "core/sweep/boundary.h"
#include "core/sweep/trapezoidation.h"

namespace trapeze {

/// Two features of a coverage that overlap, by position.
struct Overlap {
  std::uint32_t lower = 0;  // drawn first, so that it is covered there
  std::uint32_t upper = 0;
  double area = 0;  // cells squared
};

/// The result of building one coverage, for reports.
struct CoverageOutcome {
  bool built = false;        // false: nothing left to draw, or failed
  bool noded = false;        // vertices were missing on one side of a border, or borders crossed
  std::size_t vertices = 0;  // of the graph; one on a shared border counts once
  std::size_t shared_edges = 0;   // between two features
  std::size_t junctions = 0;      // vertices where three or more borders meet
  std::size_t gaps = 0;           // regions that no feature covers, with at least two around them
  std::size_t filled = 0;         // gaps narrow enough to become a part of a neighbour
  std::vector<Overlap> overlaps;  // in order of their features
  std::vector<double> areas;      // of each feature by itself, cells squared
  FaceFeatures faces;             // by position
  std::optional<MergePlan> plan;  // says what becomes a block, if anything does
  std::vector<std::uint32_t> apart;  // the features that were left out, in ascending order
  bool is_crowded = false;           // too many overlapped each other, see CoverageTolerance
  std::string failure;               // why it could not be built, empty otherwise
};

/// The overlaps and gaps that are tolerated.
struct CoverageTolerance {
  double most_overlap = 0;  // as a fraction of the area of the smaller of two features
  /// The same where the features would otherwise form a crowd: more than 64 features at a place
  /// that is a face of its own or, except in small groups, more than 16 features on the sides of
  /// edges for each vertex of a feature. Features that do not overlap have one.
  double most_overlap_in_crowd = 0;
  double widest_gap = 0;  // metres on the ground
  /// Connected places covered by the same features are faces of their own if their mean width (area
  /// over half of the border) is greater than this, in cells.
  double narrowest_overlap = std::numeric_limits<double>::infinity();
};

/// Where features overlap.
struct Overlay {
  std::vector<Overlap> overlaps;  // in order of their features
  std::vector<double> areas;      // of each feature by itself, cells squared
  std::string failure;            // why it could not be found, empty otherwise
};

/// The overlaps of features, each defined by even-odd of its own rings, which are clean (see
/// clean_rings.h).
Overlay overlay(std::span<const Rings* const> features);

/// Holds working memory for reuse. One call at a time.
class CoverageBuilder {
 public:
  /// Makes `graph` the graph of the features, each defined by even-odd of its own rings, which are
  /// clean (see clean_rings.h). The face of features[i] is i + 1. Where features overlap, the face
  /// is one of all of them together, or the last feature's if it is narrow.
  ///
  /// Gaps whose mean width (area over half of the border) is at most `widest_gap` become a part of
  /// the feature with the longest border, if their area is at most that border times `widest_gap`.
  /// If features overlap by more than is tolerated, those that share the fewest edges with
  /// neighbours are left out. Nothing is built if fewer than two remain, except for a single
  /// feature that is merged, or if they are still a crowd.
  ///
  /// Never throws for bad geometry: `graph` is meaningful only if `built` is true in the outcome.
  /// Reports progress to `share`, if given. Runs on up to `threads` threads; the graph does not
  /// depend on their number.
  CoverageOutcome build(std::span<const Rings* const> features, const CoverageTolerance& tolerance,
                        TrapezoidalGraph& graph, WorkShare* share = nullptr, unsigned threads = 1,
                        const Merging& merging = {});

 private:
  void plan_blocks(const Merging& merging, TrapezoidalGraph& graph, unsigned threads,
                   CoverageOutcome& outcome);

  Boundary boundary_;
  Trapezoidation trapezoidation_;
  BorderArcs arcs_;
};

/// The rings of every face of a coverage, by face - 1, read from its edges. They are closed, and
/// the inside of the face is given by even-odd. Where a face touches itself, a ring may pass
/// through a vertex twice.
std::vector<Rings> rings_of_faces(const TrapezoidalGraph& graph);
/// The same for every feature, by position.
std::vector<Rings> rings_of_features(const TrapezoidalGraph& graph, const FaceFeatures& faces);

}  // namespace trapeze
