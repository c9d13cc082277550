// Blends a colour over a pixel of a picture.
#pragma once

#include "render/picture/picture.h"

namespace trapeze {

/// Draws the colour over one pixel ("source over"), with its opacity multiplied by `share`, 0..1.
/// Does nothing outside the picture.
void blend(Picture& picture, int column, int row, Rgba colour, double share);

}  // namespace trapeze
