// From differences along a row of pixels to the row of a mask.
//
// The running sum of the differences is the area covered of each pixel, 1 being a whole pixel; it
// is clamped and rounded once. Differences are 0 except at the boundaries of polygons.
#pragma once

#include <cstdint>
#include <span>

#include "render/mask/mask.h"

namespace trapeze {

/// Appends a row to the mask, which is as wide as there are differences. Sets the differences to 0.
void resolve_row(std::span<float> differences, Mask& mask);
/// The same where it is known in which blocks of columns there are differences other than 0: bit b
/// of `touched` stands for the columns from b << shift on. Precondition: shift >= 3.
void resolve_row(std::span<float> differences, std::uint64_t touched, unsigned shift, Mask& mask);
/// The same as the first for integer differences, `whole` being a whole pixel. Precondition: every
/// running sum fits into 32 bits.
void resolve_row(std::span<std::int32_t> differences, std::int32_t whole, Mask& mask);

}  // namespace trapeze
