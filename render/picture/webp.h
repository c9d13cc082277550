// Encodes pictures to lossless WebP, if built with libwebp.
#pragma once

#include <string>

#include "render/picture/picture.h"

namespace trapeze {

constexpr int kMaxWebpPixels = 16383;  // maximum for either side

/// Whether this was built with libwebp; encode_webp() may only be called in that case.
bool has_webp();

/// The version of libwebp as a number; 0 without it. Another version may give other bytes.
int webp_version();

/// No pixel changes, hidden colours included. Throws std::runtime_error if the picture has no
/// pixels or more than kMaxWebpPixels per side, or if libwebp fails. Thread-safe.
std::string encode_webp(const RunPicture& picture);

}  // namespace trapeze
