// The default fonts.
#pragma once

#include <string>
#include <vector>

namespace trapeze {

/// The font files that are installed, of those in Debian's packages fonts-dejavu-core (Latin,
/// Greek, Cyrillic, Arabic, Hebrew and more), fonts-noto-core (most other scripts in use) and
/// fonts-noto-cjk (Chinese, Japanese, Korean); as Fonts::add() takes them, in order of fallback.
std::vector<std::string> usual_fonts();

}  // namespace trapeze
