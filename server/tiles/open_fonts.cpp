#include "server/tiles/open_fonts.h"

#include <spdlog/spdlog.h>

#include <stdexcept>
#include <utility>

#include "render/text/usual_fonts.h"

namespace trapeze {
namespace {

/// Adds the usable files; returns what is wrong with the others.
std::vector<std::string> add_fonts(const std::vector<std::string>& files, Fonts& fonts) {
  std::vector<std::string> problems;
  for (const std::string& file : files) {
    try {
      fonts.add(file);
    } catch (const std::runtime_error& error) {
      problems.emplace_back(error.what());
    }
  }
  return problems;
}

}  // namespace

std::shared_ptr<const Fonts> open_fonts(const std::vector<std::string>& files) {
  const auto fonts = std::make_shared<Fonts>();
  for (const std::string& problem : add_fonts(files.empty() ? usual_fonts() : files, *fonts)) {
    spdlog::warn(problem);
  }
  if (fonts->is_empty()) {
    spdlog::warn(
        "there is no font, so legends and labels show no text; install fonts-dejavu-core, or name "
        "files in text.fonts");
  }
  return fonts;
}

FontChoice open_font_choice(const Config& config, std::shared_ptr<const Fonts> usual) {
  FontChoice choice;
  choice.usual = usual == nullptr ? open_fonts(config.text.fonts) : std::move(usual);
  for (const auto& [name, fonts] : config.fonts) {
    choice.named.emplace(name, open_fonts(fonts.files));
  }
  return choice;
}

std::vector<std::string> find_font_problems(const std::vector<std::string>& files) {
  Fonts fonts;
  return add_fonts(files, fonts);
}

}  // namespace trapeze
