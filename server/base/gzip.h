// Compression as gzip(1) does it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace trapeze {

constexpr int kMostGzipLevel = 9;

/// What is longer is not compressed at once.
constexpr std::size_t kMostGzipBytes = 0xffffffff;

/// Level 1 is the quickest, kMostGzipLevel gives the fewest bytes. Equal bytes become equal ones:
/// there is no time in them. Any thread.
std::string gzip(std::string_view bytes, int level);

/// What was compressed. Nothing if it is not that, or longer than `most`. Any thread.
std::optional<std::string> gunzip(std::string_view bytes, std::size_t most);

}  // namespace trapeze
