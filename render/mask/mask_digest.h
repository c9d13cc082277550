// Digests that identify a mask before it is drawn, computed from the sides or lines that it is
// drawn from.
//
// Thread-safety: any thread.
#pragma once

#include <cstdint>
#include <span>

#include "core/grid/digest.h"
#include "render/mask/mask.h"
#include "render/mask/stroke.h"

namespace trapeze {

/// The digest of the parts of a mask in that view. Masks with equal digests and views of equal size
/// are equal if they have the same number of cells per pixel and the same renderer draws them. The
/// digest does not depend on the order or numbering of the trapezoids, on anything off the picture,
/// or on where in the world the picture is: it covers the sides as clipped to the view, in cells
/// from its corner. Sides shared by two trapezoids cancel out.
Digest mask_digest(std::span<const MeshPart> parts, const View& view);

/// The digest of a mask that covers the whole view: the result of mask_digest() if all sides are
/// west or east of the view.
Digest whole_mask_digest(const View& view);

/// The digest of lines along edges, see Stroker::draw(). Masks with equal digests, strokes, and
/// views of the same size and cells_per_pixel are equal, however the edges are numbered and
/// wherever the picture is.
Digest outline_digest(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
                      const Stroke& stroke, const View& view);

}  // namespace trapeze
