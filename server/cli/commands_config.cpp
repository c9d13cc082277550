#include <algorithm>
#include <iostream>
#include <utility>

#include "server/cli/commands.h"
#include "server/config/config_print.h"
#include "server/config/load_config.h"
#include "server/tiles/open_fonts.h"

namespace trapeze {

int run_config_check(const std::string& path) {
  LoadedConfig loaded = load_config(path, {});
  for (std::string& problem : find_font_problems(loaded.config.text.fonts)) {
    loaded.problems.push_back({loaded.origins["text.fonts"], "text.fonts: " + std::move(problem)});
  }
  if (!loaded.problems.empty()) {
    std::cerr << problems_text(loaded.problems) << '\n';
    return 1;
  }
  const std::size_t layers = loaded.config.layers.size();
  std::cout << path << ": nothing is wrong; " << layers << (layers == 1 ? " layer\n" : " layers\n");
  return 0;
}

int run_config_print(const ServeArguments& arguments) {
  std::cout << print_config(load_serve_config(arguments));
  return 0;
}

int run_config_schema() {
  std::cout << config_schema();
  return 0;
}

}  // namespace trapeze
