// The fonts that a configuration names.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/text/fonts.h"

namespace trapeze {

/// Opens the files, as Fonts::add() takes them, or the usual fonts if none are named. What cannot
/// be used is left out, and the log warns of it; also if there is no font then, and text is not
/// drawn.
std::shared_ptr<const Fonts> open_fonts(const std::vector<std::string>& files);

/// What is wrong with the files that cannot be used, one sentence each.
std::vector<std::string> find_font_problems(const std::vector<std::string>& files);

}  // namespace trapeze
