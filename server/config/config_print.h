// The configuration as text: with the origin of each value, and the schema of its file.
#pragma once

#include <string>

#include "server/config/load_config.h"

namespace trapeze {

/// TOML that gives the same configuration if it is read, with the origin of each value beside it. A
/// setting of `loaded.origins` comes from there; all others are defaults.
std::string print_config(const LoadedConfig& loaded);

/// The JSON Schema (draft 2020-12) of the file.
std::string config_schema();

}  // namespace trapeze
