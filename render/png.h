// Pictures to PNG and back, in memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/compose.h"

namespace trapeze {

/// Encodes an indexed picture with the smallest palette (1, 2, 4 or 8 bits a pixel, opacities in
/// tRNS), any other as RGB if it is opaque and else as RGBA. No pixel changes, except that wholly
/// transparent ones may lose their hidden colour. Fast rather than small: no row filters, lowest
/// level of compression. Throws std::runtime_error if libpng fails.
std::vector<std::uint8_t> encode_png(const Picture& picture);

/// Decodes any PNG to a picture of colours. Throws std::runtime_error, saying why, if it cannot.
Picture decode_png(std::span<const std::uint8_t> bytes);

}  // namespace trapeze
