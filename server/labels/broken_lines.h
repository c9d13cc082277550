// Text broken into lines.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "render/text/fonts.h"

namespace trapeze {

struct BrokenLines {
  std::vector<std::string> lines;
  double width = 0;        // of the widest line, in ems
  double line_height = 0;  // in ems
};

/// Breaks text into lines of at most `most` ems where possible: at spaces, after hyphens, slashes
/// and commas, and between Chinese, Japanese and Korean characters. Uses as few lines as possible,
/// and makes these as equal in width as possible. Thread-safe.
BrokenLines broken_lines(std::string_view text, double most, const Fonts& fonts);

}  // namespace trapeze
