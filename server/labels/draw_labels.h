// Puts labels on a picture.
#pragma once

#include <span>

#include "render/picture/picture.h"
#include "server/labels/label_book.h"

namespace trapeze {

/// One after the other: the halo of each, and its letters over it. Rows without labels stay as they
/// are. Thread-safe.
void draw_labels(std::span<const DrawnLabel> labels, RunPicture& picture);

}  // namespace trapeze
