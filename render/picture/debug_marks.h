// Marks drawn over a picture that show how it was made (paper, Figure 7 f to j): the trapezoids,
// the vertices that are left, the faces and their junctions, the border of a tile.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/mesh/trapezoid_mesh.h"
#include "render/mask/mask.h"
#include "render/picture/picture.h"

namespace trapeze {

/// Draws thin lines along all sides of the trapezoids. `picture` is of the view's size, here and
/// below.
void mark_mesh(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const View& view,
               Rgba colour, Picture& picture);

/// Draws a small square at every vertex that is an end of an edge of the trapezoids.
void mark_vertices(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const View& view,
                   Rgba colour, Picture& picture);

/// The feature that a trapezoid of the mesh is a part of, by number.
using FeatureOf = std::function<std::uint32_t(std::uint32_t trapezoid)>;

/// Tints what the trapezoids cover, each feature in a colour of its own, which depends on its
/// number only. None of them overlap.
void mark_faces(const MeshView& mesh, std::span<const TrapezoidRange> ranges,
                const FeatureOf& feature_of, const View& view, Picture& picture);

/// Draws a dot at every junction: a vertex around which three or more features meet, the outside
/// counting as one. `horizontal_edges` are trapezoids without height that stand for edges, as
/// Layer::select_horizontal_edges finds them. A vertex is classified correctly if both include all
/// that touches it; so they should be selected from a box a little larger than the picture.
void mark_junctions(const MeshView& mesh, std::span<const TrapezoidRange> ranges,
                    std::span<const TrapezoidRange> horizontal_edges, const FeatureOf& feature_of,
                    const View& view, Rgba colour, Picture& picture);

/// Draws a line along the border of the picture.
void mark_border(Rgba colour, Picture& picture);

}  // namespace trapeze
