#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cstddef>
#include <iostream>
#include <string>

#include "server/cli/commands.h"
#include "server/config/config_print.h"
#include "server/config/load_config.h"
#include "server/service/config_check.h"

namespace trapeze {

namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

}  // namespace

int run_config_check(const std::string& path) {
  const LoadedConfig loaded = load_config(path, environment_overrides(environ));
  ConfigFindings findings = check_config(loaded, path);
  for (ConfigProblem& warning : findings.warnings) warning.what = "warning: " + warning.what;
  for (const auto& found : {findings.problems, findings.warnings}) {
    if (!found.empty()) std::cerr << problems_text(found) << '\n';
  }
  if (!findings.problems.empty()) return 1;
  const std::size_t warnings = findings.warnings.size();
  const std::string starts =
      loaded.config.layers.empty() ? "the server starts with files only" : "the server starts";
  std::cout << fmt::format(
      "{}: {}; {}\n", path,
      warnings == 0 ? "nothing is wrong"
                    : fmt::format("{}, with {}", starts, counted(warnings, "warning", "warnings")),
      counted(loaded.config.layers.size(), "layer", "layers"));
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
