// A pixel of a picture under a colour.
#pragma once

#include "render/picture/picture.h"

namespace trapeze {

/// Lays the colour over one pixel, source over, its opacity multiplied with `share`, 0..1.
/// Nothing is done outside of the picture.
void blend(Picture& picture, int column, int row, Rgba colour, double share);

}  // namespace trapeze
