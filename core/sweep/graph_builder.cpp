#include "core/sweep/graph_builder.h"

#include <optional>
#include <utility>
#include <vector>

#include "core/grid/item_count.h"
#include "core/sweep/clean_rings.h"
#include "core/sweep/noding.h"

namespace trapeze {

bool GraphBuilder::sweep(TrapezoidalGraph& graph, unsigned threads) {
  if (threads == 1) return trapezoidation_.build(boundary_, graph);
  const FaceBeyond by_even_odd = [](EdgeId, FaceId left) {
    return left == kOutside ? 1 : kOutside;
  };
  return trapezoidation_.build(boundary_, by_even_odd, graph, threads);
}

BuildOutcome GraphBuilder::build(Rings& rings, TrapezoidalGraph& graph, unsigned threads) {
  BuildOutcome outcome;
  outcome.rings = rings.size();
  outcome.collapsed_rings = clean_rings(rings);
  if (rings.empty()) return outcome;
  if (rings.points.size() > kMostSegments) {
    outcome.failure = too_many_words(rings.points.size(), "vertices", kMostSegments);
    return outcome;
  }

  boundary_.assign(rings);
  if (sweep(graph, threads)) {
    if (boundary_.has_touches) {
      loops_.trace(boundary_, graph);
    } else {
      loops_.take_rings(rings, boundary_, graph);
    }
    outcome.built = true;
  } else {
    outcome.noded = true;
    outcome.built = build_noded(rings, graph, threads, outcome);
  }
  outcome.vertices = outcome.built ? graph.vertex_count() : 0;
  return outcome;
}

bool GraphBuilder::build_noded(const Rings& rings, TrapezoidalGraph& graph, unsigned threads,
                               BuildOutcome& outcome) {
  // Noding only at crossings is fast and is repeated while it may help. Noding at all vertices
  // suffices in one pass; it is repeated only for safety.
  constexpr int kQuickPasses = 3;
  constexpr int kMaxPasses = 6;
  std::vector<Segment> segments = segments_of(rings);
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    std::optional<std::vector<Segment>> noded =
        node_segments(segments, boundary_,
                      pass < kQuickPasses ? HotCells::crossings : HotCells::crossings_and_vertices);
    if (!noded) {
      outcome.failure =
          "crosses itself more than " + std::to_string(most_meetings(segments.size())) + " times";
      return false;
    }
    segments = std::move(*noded);
    if (segments.empty()) return false;  // everything cancelled: no area
    if (segments.size() > kMostSegments) {
      outcome.failure = too_many_words(segments.size(), "pieces of its boundary", kMostSegments);
      return false;
    }
    boundary_.assign(segments);
    if (sweep(graph, threads)) {
      loops_.trace(boundary_, graph);
      return true;
    }
  }
  outcome.failure =
      "its rings still cross after " + std::to_string(kMaxPasses) + " passes of noding";
  return false;
}

}  // namespace trapeze
