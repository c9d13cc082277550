// Moves large arrays into the processor's large pages: the items drawn are scattered over a layer,
// and the address of each small page has to be looked up on first access.
#pragma once

#include <cstddef>

#include "core/layer/layer.h"

namespace trapeze {

/// Moves the arrays of the layer into pages of 2 MB as far as they fill whole ones, so that they
/// take no more memory. Returns the number of large pages: 0 if the system has none to offer (Linux
/// before 6.1, no contiguous free memory), which is not an error. No pointer changes. May be called
/// from any thread while others read.
std::size_t move_to_huge_pages(const Layer& layer);

}  // namespace trapeze
