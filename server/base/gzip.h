// Compression compatible with gzip(1).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace trapeze {

constexpr int kMostGzipLevel = 9;

/// Longer input cannot be compressed in one call.
constexpr std::size_t kMostGzipBytes = 0xffffffff;

/// Level 1 is the fastest, kMostGzipLevel gives the smallest output. Equal input gives equal
/// output: no time is stored. Any thread.
std::string gzip(std::string_view bytes, int level);

/// Decompresses. Nothing if the input is not valid, or the output is longer than `most`. Any
/// thread.
std::optional<std::string> gunzip(std::string_view bytes, std::size_t most);

}  // namespace trapeze
