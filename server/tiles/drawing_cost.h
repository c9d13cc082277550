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
#include <limits>

#include "server/tiles/tile_plan.h"

namespace trapeze {

constexpr std::uint64_t kPixelsPerSide = 16;
constexpr std::uint64_t kSidesPerOutlineEdge = 4;
constexpr std::uint64_t kSidesPerDashedEdge = 16;
constexpr std::uint64_t kSidesPerMarkedTrapezoid = 32;  // of debug=mesh and the like

/// From the counts of the indexes alone: microseconds for most tiles, and for the greatest about a
/// tenth of the time that it takes to select what is drawn. Never less for a picture that shows
/// more, or has wider lines. A cost beyond `most` is told as any number beyond it, so that the
/// counting ends early.
std::uint64_t drawing_cost(const TilePlan& plan,
                           std::uint64_t most = std::numeric_limits<std::uint32_t>::max());

}  // namespace trapeze
