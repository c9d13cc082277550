// Marks over a picture that show how it came about (paper, Figure 7 f to j): the trapezoids, the
// vertices that are kept, the border of a tile and its numbers.
#pragma once

#include <span>
#include <string_view>

#include "core/trapezoid_mesh.h"
#include "render/compose.h"
#include "render/coverage.h"

namespace trapeze {

/// Gives the picture one colour a pixel, so that marks can be drawn on it.
void spread_palette(Picture& picture);

/// Draws thin lines along all sides of the trapezoids. `picture` is not indexed and of the view's
/// size, here and below.
void mark_mesh(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const View& view,
               Rgba colour, Picture& picture);

/// Draws a small square at every vertex that is an end of an edge of the trapezoids.
void mark_vertices(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const View& view,
                   Rgba colour, Picture& picture);

/// Draws a line along the border of the picture, and the text in its upper left corner: digits,
/// slashes, 'x' and spaces, five pixels high.
void mark_border(std::string_view text, Rgba colour, Picture& picture);

}  // namespace trapeze
