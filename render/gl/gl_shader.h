// The compute shader of GlRenderer: from trapezoids to differences of covered area.
//
// What is added up is not coverage but its difference from each pixel to the one west of it, which
// is summed up along the rows afterwards. So only the pixels that a side runs through are touched,
// and their eastern neighbours, however large the area between two sides.
//
// An invocation takes one side of a trapezoid from row to row. It makes the integers of the side
// relative to the picture and cuts them to it in double precision, integrates the area east of it
// in closed form, and adds that to integers, in units of 1 / kUnitsPerPixel: sums of integers are
// the same in whatever order they come about. What is left of a unit is rounded up or down by a
// share that differs from trapezoid to trapezoid, so that thousands of them in one pixel are not
// all rounded one way; it is the same for both sides, so that east of a trapezoid nothing is left
// over.
#pragma once

#include <string>

namespace trapeze::gl_shader {

/// Units of a wholly covered pixel.
constexpr int kUnitsPerPixel = 1 << 17;

/// Trapezoids of which no sum of differences leaves 32 bits.
constexpr unsigned kMostTrapezoids = (1u << 14) - 1;

/// Invocations of a group; a trapezoid takes two.
constexpr unsigned kGroup = 64;

/// Where the shader finds its storage buffers: indices of trapezoids, and the differences.
constexpr unsigned kIndicesBinding = 0;
constexpr unsigned kDifferencesBinding = 1;

std::string source();

}  // namespace trapeze::gl_shader
