// The compute shader of GlRenderer: from trapezoids to differences of covered area.
//
// What is added up is not the covered area of a pixel but its difference from that of the pixel to
// the west; resolve_row() sums the differences along each row afterwards. So only the pixels that a
// side passes through are written, and their eastern neighbours, however far apart two sides are.
//
// One invocation walks along one side of a trapezoid, row by row. In double precision, it moves the
// integer coordinates of the side to the origin of the picture and clips the side to the picture;
// then it integrates the area east of the side in closed form and adds that to integers, in units
// of 1 / kUnitsPerPixel, see resolve_row(). Fractions of a unit are rounded at a threshold that
// differs from trapezoid to trapezoid (a dither), so that the errors of thousands of trapezoids in
// one pixel do not all have the same sign. The threshold is that of the rows of the picture that
// the trapezoid reaches over: so both sides have the same, their sum is exactly 0 east of it, and
// what lies off the picture does not matter. Heights are differences of rounded places, so that
// those of trapezoids above each other add up.
#pragma once

#include <string>

namespace trapeze::gl_shader {

/// Invocations in a work group; each trapezoid takes two.
constexpr unsigned kGroup = 64;

/// Binding points of the shader's storage buffers: the indices of the trapezoids, and the
/// differences.
constexpr unsigned kIndicesBinding = 0;
constexpr unsigned kDifferencesBinding = 1;

/// The source text of the shader, in GLSL.
std::string source();

}  // namespace trapeze::gl_shader
