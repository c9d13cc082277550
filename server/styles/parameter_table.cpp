#include "server/styles/parameter_table.h"

#include <spdlog/fmt/fmt.h>

#include "server/styles/style_parameters.h"

namespace trapeze {

std::string parameter_table() {
  std::string table = "| parameter | meaning | value | default |\n|---|---|---|---|\n";
  for (const StyleParameter& parameter : style_parameters()) {
    table += fmt::format("| `{}` | {} | {} | {} |\n", parameter.name, parameter.description,
                         describe_values(parameter), parameter.default_text);
  }
  return table;
}

}  // namespace trapeze
