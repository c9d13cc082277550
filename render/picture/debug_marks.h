// Marks drawn over a picture that show how it was made (paper, Figure 7 f to j): the trapezoids,
// the remaining vertices, the faces and their junctions, the border of a tile.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/mesh/trapezoid_mesh.h"
#include "render/mask/mask.h"
#include "render/picture/picture.h"

namespace trapeze {

/// Draws thin lines along all sides of the trapezoids. `picture` has the size of the view, here and
/// below.
void mark_mesh(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const View& view,
               Rgba colour, Picture& picture);

/// Draws a small square at every vertex that is an end of an edge of the trapezoids.
void mark_vertices(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const View& view,
                   Rgba colour, Picture& picture);

/// The number of the feature that a trapezoid of the mesh belongs to.
using FeatureOf = std::function<std::uint32_t(std::uint32_t trapezoid)>;

/// Tints the area covered by the trapezoids, each feature in a colour that depends only on its
/// number. The trapezoids must not overlap.
void mark_faces(const MeshView& mesh, std::span<const TrapezoidRange> ranges,
                const FeatureOf& feature_of, const View& view, Picture& picture);

/// Draws a dot at every junction: a vertex where three or more features meet, the outside counting
/// as one. `horizontal_edges` are trapezoids without height that represent edges, as found by
/// Layer::select_horizontal_edges(). A vertex is classified correctly if both include everything
/// that touches it, so select them from a box slightly larger than the picture.
void mark_junctions(const MeshView& mesh, std::span<const TrapezoidRange> ranges,
                    std::span<const TrapezoidRange> horizontal_edges, const FeatureOf& feature_of,
                    const View& view, Rgba colour, Picture& picture);

/// Draws a line along the border of the picture.
void mark_border(Rgba colour, Picture& picture);

}  // namespace trapeze
