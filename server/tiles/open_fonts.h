// The fonts that a configuration names.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/text/fonts.h"
#include "server/config/config.h"
#include "server/labels/label_book.h"

namespace trapeze {

/// Opens the files, as Fonts::add() takes them, or the usual fonts if none are named. What cannot
/// be used is left out, and the log warns of it; also if there is no font then, and text is not
/// drawn.
std::shared_ptr<const Fonts> open_fonts(const std::vector<std::string>& files);

/// The fonts of a configuration: the usual ones, and those that labels may choose. The former are
/// `usual`, if that is not null.
FontChoice open_font_choice(const Config& config, std::shared_ptr<const Fonts> usual = nullptr);

/// What is wrong with the files that cannot be used, one sentence each.
std::vector<std::string> find_font_problems(const std::vector<std::string>& files);

}  // namespace trapeze
