#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "server/base/nearest_name.h"
#include "server/cli/commands.h"

namespace trapeze {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "trapeze-";

/// The folders of benchmark programs: next to this program in the build folder, or where it is
/// installed.
std::vector<fs::path> folders() {
  const fs::path here = fs::read_symlink("/proc/self/exe").parent_path();
  return {here / "bench", here};
}

bool is_program(const fs::path& path) {
  return fs::is_regular_file(path) && access(path.c_str(), X_OK) == 0;
}

std::vector<std::string> names() {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::path& folder : folders()) {
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const std::string file = entry.path().filename().string();
      if (file.starts_with(kPrefix) && is_program(entry.path())) {
        names.push_back(file.substr(std::strlen(kPrefix)));
      }
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

[[noreturn]] void throw_unknown(const std::string& name) {
  const std::vector<std::string> known = names();
  std::string text = "there is no benchmark \"" + name + "\" beside this program";
  for (const std::string& each : known) text.append("; there is ").append(each);
  throw UsageError(text + "; build the release preset for all of them" + did_you_mean(name, known));
}

}  // namespace

int run_bench(const BenchArguments& arguments) {
  const bool is_name =
      !arguments.name.empty() &&
      arguments.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_-") == std::string::npos;
  if (!is_name) throw_unknown(arguments.name);
  for (const fs::path& folder : folders()) {
    const std::string program = (folder / (kPrefix + arguments.name)).string();
    if (!is_program(program)) continue;
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& option : arguments.options) {
      argv.push_back(const_cast<char*>(option.c_str()));
    }
    argv.push_back(nullptr);
    execv(program.c_str(), argv.data());
    throw std::system_error(errno, std::generic_category(), program);
  }
  throw_unknown(arguments.name);
}

}  // namespace trapeze
