// The compute shader of GlRenderer: from trapezoids to differences of covered area.
//
// What is added up is not coverage but its difference from each pixel to the one west of it, which
// is summed up along the rows afterwards. So only the pixels that a side runs through are touched,
// and their eastern neighbours, however large the area between two sides.
//
// An invocation takes one side of a trapezoid from row to row. It makes the integers of the side
// relative to the picture and cuts them to it in double precision, integrates the area east of the
// side in closed form, and adds it in units of 1 / kGlUnitsPerPixel to integers: sums of integers
// are the same in whatever order they come about. What of a unit is left is rounded up or down by a
// share that differs from trapezoid to trapezoid, so that thousands in one pixel are not all
// rounded to one side.
#pragma once

#include <string>

namespace trapeze {

/// Units of a wholly covered pixel.
constexpr int kGlUnitsPerPixel = 1 << 17;

/// Trapezoids of which no sum of differences leaves 32 bits.
constexpr int kGlMostTrapezoids = (1 << 14) - 1;

/// Invocations of a group.
constexpr int kGlGroup = 64;

/// Where the shader finds its buffers.
constexpr unsigned kGlTrapezoidsBinding = 0;
constexpr unsigned kGlChosenBinding = 1;
constexpr unsigned kGlDifferencesBinding = 2;

std::string side_shader();

}  // namespace trapeze
