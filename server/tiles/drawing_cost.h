// What a tile costs to draw, known before anything is drawn.
//
// The unit is the side of a trapezoid that is put into a picture, of which a worker draws some 25
// million a second (software renderer, one core of 2.5 GHz). An edge of an outline costs several, a
// grain of dust that is told by class one, and so do kPixelsPerSide values of pixels that outlines,
// masks and colours touch.
//
// Thread-safety: any number of threads.
#pragma once

#include <cstdint>

#include "server/tiles/tile_plan.h"

namespace trapeze {

constexpr std::uint64_t kPixelsPerSide = 16;
constexpr std::uint64_t kSidesPerOutlineEdge = 4;
constexpr std::uint64_t kSidesPerDashedEdge = 8;
constexpr std::uint64_t kSidesPerRoundedTrapezoid = 40;  // of its corners, sides of new trapezoids
constexpr std::uint64_t kSidesPerGrownTrapezoid = 120;   // looking around, by how far that is:
constexpr std::uint64_t kSidesPerGrownPixel = 40;        // of the width, so many more of each
constexpr std::uint64_t kSidesPerPartSeenThrough = 64;
constexpr std::uint64_t kSidesPerProjectedTrapezoid = 2;  // in plate carree
constexpr std::uint64_t kSidesPerMarkedTrapezoid = 32;    // of debug=mesh and the like

/// Estimated from the indexes alone, see MeshIndex::estimate(): microseconds for most tiles,
/// milliseconds for millions of trapezoids. Never less for a picture that shows more, or has wider
/// lines.
std::uint64_t drawing_cost(const TilePlan& plan);

}  // namespace trapeze
