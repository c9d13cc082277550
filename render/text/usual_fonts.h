// The fonts that are taken where none are named.
#pragma once

#include <string>
#include <vector>

namespace trapeze {

/// Of the fonts of Debian's packages fonts-dejavu-core (Latin, Greek, Cyrillic, Arabic, Hebrew and
/// more), fonts-noto-core (most other scripts in use) and fonts-noto-cjk (Chinese, Japanese,
/// Korean) the files that are there, as Fonts::add() takes them, in a good order of fallback.
std::vector<std::string> usual_fonts();

}  // namespace trapeze
