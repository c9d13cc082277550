// Closes narrow gaps and overlaps between polygons whose borders were digitized separately, so that
// they run beside each other instead of coinciding.
//
// First, vertices are moved to the nearest vertex of another polygon. Then edges are routed through
// the vertices of other polygons beside them. The result is noded like any coverage. Gaps between
// borders that could not be joined remain, and are filled if they are narrow enough (see
// CoverageBuilder).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/grid/rings.h"

namespace trapeze {

/// The greatest width of a gap that may be closed, in metres.
constexpr double kWidestGap = 1000;

/// The result of close_gaps(). Features are given by position, in ascending order.
struct GapClosing {
  std::size_t moved = 0;              // vertices moved to a vertex of another feature
  std::size_t led = 0;                // vertices through which edges of other features were routed
  std::vector<Rings> drawn;           // by feature: its original rings; empty if unchanged
  std::vector<std::uint32_t> narrow;  // excluded: their area is less than their boundary's length
                                      // times the distance
  std::vector<std::uint32_t> kept;    // excluded: they would have overlapped, or changed by more
  std::string failure;                // why nothing was closed, empty otherwise
};

/// Makes borders of different features coincide where they are at most `metres` apart on the
/// ground; 0 < metres <= kWidestGap.
///
/// * A vertex moves by no more than that, and only to a vertex such that each of the two has a
///   feature that the other does not have. So details of one feature, or of a border of two, are
///   kept; but where a feature is that narrow between two others, its sides are joined. The edges
///   beside a vertex may bend by as much again.
/// * No feature changes its area by more than the length of its boundary times the distance, and no
///   two features come to overlap by more than before, except for a strip of one cell. Features
///   that would, and those so narrow that their shape might be lost, stay unchanged, together with
///   everything that others share with them, and attract no others.
/// * Closes nothing if too much lies within the distance to be examined in a few seconds, or if the
///   process does not converge.
///
/// Rings are clean before and after (see clean_rings.h). The result depends only on the features
/// and their order.
GapClosing close_gaps(std::span<Rings* const> features, double metres);

}  // namespace trapeze
