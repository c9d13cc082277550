// Converts differences along a row of pixels to the row of a mask.
//
// The running sum of the differences is the covered area of each pixel; it is clamped to a whole
// pixel and rounded once. Differences are integers, 0 except at the boundaries of polygons. Sums of
// integers do not depend on the order of their terms, so a mask does not depend on the order in
// which its trapezoids were added.
#pragma once

#include <cstdint>
#include <span>

#include "render/mask/mask.h"

namespace trapeze {

/// Units of a fully covered pixel.
constexpr std::int32_t kUnitsPerPixel = 1 << 17;

/// The number of trapezoids that can be summed before a sum of differences may overflow 32 bits.
constexpr std::uint32_t kMostTrapezoids = (1u << 14) - 1;

/// Appends a row to the mask, which must be as wide as there are differences. Sets the differences
/// to 0. Precondition: every running sum fits into 32 bits.
void resolve_row(std::span<std::int32_t> differences, Mask& mask);
/// The same if it is known which blocks of columns contain differences other than 0: bit b of
/// `touched` represents the columns from b << shift on. Precondition: shift >= 3.
void resolve_row(std::span<std::int32_t> differences, std::uint64_t touched, unsigned shift,
                 Mask& mask);
/// The same as the first one, for any number of trapezoids.
void resolve_row(std::span<std::int64_t> differences, Mask& mask);

}  // namespace trapeze
