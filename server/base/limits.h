// Upper limits for a single request; operators may set lower ones (LimitsConfig).
#pragma once

#include <cstddef>
#include <cstdint>

namespace trapeze {

constexpr std::size_t kMaxTargetLength = 4096;  // bytes of path and query together
constexpr std::size_t kMaxLayersPerTile = 16;
constexpr int kMaxScale = 4;
constexpr std::uint64_t kMaxMapPixels = 67'108'864;  // of the picture of a window: 8192 x 8192

}  // namespace trapeze
