// Configurations: errors of any text are reported with line and column, and `trapeze config print`
// prints a valid configuration with the same values.
//
// Input: the text of a TOML file.
#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "core/io/source/source_name.h"
#include "server/config/config_print.h"
#include "server/config/config_settings.h"
#include "server/config/load_config.h"
#include "tests/fuzz/require.h"

namespace trapeze {
namespace {

using fuzzing::require;

const std::string kPath = "fuzz.toml";

/// Configurations may refer to these variables only, so that findings are reproducible.
bool set_environment() {
  clearenv();
  setenv("A", "a$\"b\\", 1);
  setenv("NONE", "", 1);
  return true;
}

std::size_t number_before(std::string_view& text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  require(error == std::errc(), "a problem does not say where it is");
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

void check_problem(const ConfigProblem& problem, std::size_t lines) {
  require(!problem.what.empty(), "a problem without words");
  std::string_view where = problem.where;
  require(where.starts_with(kPath + ":"), "a problem is not in the file");
  where.remove_prefix(kPath.size() + 1);
  const std::size_t line = number_before(where);
  require(line >= 1 && line <= lines, "a problem is in a line that there is not");
  require(where.starts_with(':'), "a problem has no column");
  where.remove_prefix(1);
  require(number_before(where) >= 1 && where.empty(), "a problem is in no column");
}

/// A password is not printed, and the text printed in its place may even be read as a path.
template <typename Owner>
bool has_password(const Setting<Owner>& setting, const SettingValue& value) {
  if (setting.type != SettingType::path) return false;
  const auto& text = std::get<std::string>(value);
  return name_of_source(text) != text;
}

template <typename Owner>
void check_settings(const std::vector<Setting<Owner>>& settings, const Owner& a, const Owner& b) {
  for (const auto& setting : settings) {
    const SettingValue value = setting.get(a);
    require(value == setting.get(b) || has_password(setting, value),
            setting.name() + " is not printed as it is");
  }
}

void check_print(const LoadedConfig& loaded) {
  const std::string printed = print_config(loaded);
  const LoadedConfig again = load_config_text(printed, kPath);
  require(again.problems.empty(), problems_text(again.problems) + "\nin what is printed");
  const Config& a = loaded.config;
  const Config& b = again.config;
  check_settings(config_settings(), a, b);
  require(a.layers.size() == b.layers.size(), "not all layers are printed");
  for (std::size_t i = 0; i < a.layers.size(); ++i) {
    check_settings(layer_settings(), a.layers[i], b.layers[i]);
    require(a.layers[i].style.canonical_text() == b.layers[i].style.canonical_text(),
            "the style of a layer is not printed as it is");
  }
  const bool are_same = std::ranges::equal(a.styles, b.styles, [](const auto& x, const auto& y) {
    return x.first == y.first && x.second.canonical_text() == y.second.canonical_text();
  });
  require(are_same, "styles are not printed as they are");
}

void check_header_values(const ServerConfig& server) {
  for (const std::string& text : {server.cache_control, server.public_url}) {
    require(std::ranges::none_of(text, [](char c) { return c >= 0 && c < ' '; }),
            "what stands in headers has a line end");
  }
}

void check(std::string_view text) {
  static const bool has_environment [[maybe_unused]] = set_environment();
  const LoadedConfig loaded = load_config_text(text, kPath);
  const auto lines = 1 + static_cast<std::size_t>(std::ranges::count(text, '\n'));
  for (const ConfigProblem& problem : loaded.problems) check_problem(problem, lines);
  check_header_values(loaded.config.server);
  if (loaded.problems.empty()) check_print(loaded);
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trapeze::check(trapeze::fuzzing::text_of(data, size));
  return 0;
}
