// Prints the configuration as text, with the origin of each value, and the schema of its file.
#pragma once

#include <string>

#include "server/config/load_config.h"

namespace trapeze {

/// TOML that gives the same configuration when read, with the origin of each value next to it.
/// Settings in `loaded.origins` have their origin from there; all others are defaults.
std::string print_config(const LoadedConfig& loaded);

/// The JSON Schema (draft 2020-12) of the configuration file.
std::string config_schema();

}  // namespace trapeze
