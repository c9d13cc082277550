// Estimates what a tile costs to draw, before anything is drawn.
//
// The unit is one side of a trapezoid drawn into a picture. A worker draws about 25 million of
// these a second (software renderer, one core at 2.5 GHz). An edge of an outline costs several
// units. A grain of dust whose class has to be determined costs one, and so do kPixelsPerSide pixel
// values touched by outlines, masks and colours.
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
constexpr std::uint64_t kSidesPerGrownTrapezoid = 120;   // to search its surroundings, which
constexpr std::uint64_t kSidesPerGrownPixel = 4;         // grow by this per pixel of the width
constexpr std::uint64_t kSidesPerPartSeenThrough = 64;
constexpr std::uint64_t kSidesPerProjectedTrapezoid = 2;  // in plate carree
constexpr std::uint64_t kSidesPerMarkedTrapezoid = 32;    // for debug=mesh and similar
constexpr std::uint64_t kSidesPerMarkedPixel = 1;         // drawn one by one, not as runs
constexpr std::uint64_t kSidesPerWebpPixel = 1;           // flat ones take less, patterns twice

/// An estimate from the indexes alone, see MeshIndex::estimate(): takes microseconds for most
/// tiles, milliseconds for millions of trapezoids. Never lower for a picture that shows more or has
/// wider lines.
std::uint64_t drawing_cost(const TilePlan& plan);

/// The cost of encoding the picture, apart from what drawing_cost() counts for its pixels. PNG
/// takes runs of equal pixels and costs next to nothing.
std::uint64_t encoding_cost(const TilePlan& plan);

}  // namespace trapeze
