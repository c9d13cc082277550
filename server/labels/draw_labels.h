// Draws labels into a picture.
#pragma once

#include <span>

#include "render/picture/picture.h"
#include "server/labels/label_book.h"

namespace trapeze {

/// Draws them one after the other, each with its halo below its letters. Rows without labels are
/// not changed. Thread-safe.
void draw_labels(std::span<const DrawnLabel> labels, RunPicture& picture);

}  // namespace trapeze
