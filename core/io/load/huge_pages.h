// Large arrays in the large pages of the processor: what is drawn lies scattered over a layer, and
// each small page that is touched first has to be found.
#pragma once

#include <cstddef>

#include "core/layer/layer.h"

namespace trapeze {

/// Moves the arrays of the layer into pages of 2 MB as far as they fill whole ones, so that they
/// take no more memory. Returns how many pages there are now: none where the system has none to
/// give (Linux before 6.1, no free memory in one piece), which is no error. No pointer changes;
/// from any thread, while others read.
std::size_t move_to_huge_pages(const Layer& layer);

}  // namespace trapeze
