// The compute shader of GlRenderer: converts trapezoids to differences of covered area.
//
// The shader adds up not the covered area of a pixel but its difference from that of the pixel to
// the west; resolve_row() sums the differences along each row afterwards. So only the pixels
// crossed by a side are written, and their eastern neighbours, however far apart two sides are.
//
// One invocation walks along one side of a trapezoid, row by row. In double precision, it moves the
// integer coordinates of the side to the origin of the picture and clips the side to the picture.
// Then it integrates the area east of the side in closed form and adds that to integers, in units
// of 1 / kUnitsPerPixel, see resolve_row(). Fractions of a unit are rounded at a threshold that
// differs from trapezoid to trapezoid (a dither), so that the errors of thousands of trapezoids in
// one pixel do not all have the same sign. The threshold depends on the rows of the picture that
// the trapezoid covers: so both sides have the same one, their sum is exactly 0 east of the
// trapezoid, and anything off the picture does not matter. Heights are differences of rounded
// positions, so those of trapezoids above each other add up.
#pragma once

#include <string>

namespace trapeze::gl_shader {

/// Invocations per work group; each trapezoid needs two.
constexpr unsigned kGroup = 64;

/// Binding points of the shader's storage buffers: the indices of the trapezoids, and the
/// differences.
constexpr unsigned kIndicesBinding = 0;
constexpr unsigned kDifferencesBinding = 1;

/// The source text of the shader, in GLSL.
std::string source();

}  // namespace trapeze::gl_shader
