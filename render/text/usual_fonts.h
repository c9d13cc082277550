// The default fonts.
#pragma once

#include <string>
#include <vector>

namespace trapeze {

/// The installed font files among those of the Debian packages fonts-dejavu-core (Latin, Greek,
/// Cyrillic, Arabic, Hebrew and more), fonts-noto-core (most other scripts in use) and
/// fonts-noto-cjk (Chinese, Japanese, Korean), in the format of Fonts::add() and in order of
/// fallback.
std::vector<std::string> usual_fonts();

}  // namespace trapeze
