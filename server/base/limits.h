// Bounds of what one request may ask for; an operator may set lower ones (LimitsConfig).
#pragma once

#include <cstddef>

namespace trapeze {

constexpr std::size_t kMaxTargetLength = 4096;  // bytes of path and query together
constexpr std::size_t kMaxLayersPerTile = 16;
constexpr int kMaxScale = 4;

}  // namespace trapeze
