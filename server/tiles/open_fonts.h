// Opens the fonts that a configuration names.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/text/fonts.h"
#include "server/config/config.h"
#include "server/labels/label_book.h"

namespace trapeze {

/// Opens the files, as Fonts::add() accepts them, or the usual fonts if none are named. Files that
/// cannot be used are left out with a warning in the log. The log also warns if no font is left;
/// text is not drawn then.
std::shared_ptr<const Fonts> open_fonts(const std::vector<std::string>& files);

/// The fonts of a configuration: the usual ones, and those that labels may choose. `usual` replaces
/// the usual ones if it is not null.
FontChoice open_font_choice(const Config& config, std::shared_ptr<const Fonts> usual = nullptr);

/// What is wrong with the files that cannot be used, one sentence each.
std::vector<std::string> find_font_problems(const std::vector<std::string>& files);

}  // namespace trapeze
