// Pictures to lossless WebP, if built with libwebp.
#pragma once

#include <string>

#include "render/picture/picture.h"

namespace trapeze {

constexpr int kMaxWebpPixels = 16383;  // along either side

/// Whether this was built with libwebp; only then may encode_webp() be called.
bool has_webp();

/// The version of libwebp, as a number; 0 without it. Pictures may have other bytes with another
/// one.
int webp_version();

/// No pixel changes, hidden colours included. Throws std::runtime_error if the picture has no
/// pixels, has more than kMaxWebpPixels a side, or libwebp fails. Thread-safe.
std::string encode_webp(const RunPicture& picture);

}  // namespace trapeze
