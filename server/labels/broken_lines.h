// Text broken into lines.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "render/text/fonts.h"

namespace trapeze {

struct BrokenLines {
  std::vector<std::string> lines;
  double width = 0;        // of the widest, in ems
  double line_height = 0;  // in ems
};

/// Lines of at most `most` ems where that is possible: text may be broken at spaces, after hyphens,
/// slashes and commas, and between Chinese, Japanese and Korean characters. As few lines as that
/// takes, and these as equally wide as they can be. Thread-safe.
BrokenLines broken_lines(std::string_view text, double most, const Fonts& fonts);

}  // namespace trapeze
