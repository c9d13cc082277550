// What tells a mask from others before it is drawn: a digest of the sides, or of the lines, that it
// is drawn from.
//
// Thread-safety: any thread.
#pragma once

#include <cstdint>
#include <span>

#include "core/grid/digest.h"
#include "render/mask/mask.h"
#include "render/mask/stroke.h"

namespace trapeze {

/// Of the parts of a mask in that view. Masks of equal digests and views of the same size are
/// equal if they have as many cells a pixel and the same renderer draws them. It depends neither on
/// the order of the trapezoids, nor on how they are numbered, nor on what lies off the picture, nor
/// on where in the world the picture is: what counts is sides as they are cut to the view, in cells
/// from its corner. Sides that two trapezoids have in common cancel out.
Digest mask_digest(std::span<const MeshPart> parts, const View& view);

/// The digest of a mask that covers the view wholly, as mask_digest() finds it whenever there is
/// nothing but sides to the west and to the east of the view.
Digest whole_mask_digest(const View& view);

/// Of lines along edges, see Stroker::draw(). Masks of equal digests, strokes, and views of the
/// same size and cells_per_pixel are equal, however the edges are numbered and wherever the picture
/// is.
Digest outline_digest(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
                      const Stroke& stroke, const View& view);

}  // namespace trapeze
