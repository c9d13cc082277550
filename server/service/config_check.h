// Checks whether a server would start with a configuration.
#pragma once

#include <string>
#include <vector>

#include "server/config/load_config.h"

namespace trapeze {

struct ConfigFindings {
  std::vector<ConfigProblem> problems;  // that keep the server from starting
  std::vector<ConfigProblem> warnings;  // the server starts and logs them
};

/// Finds all problems of a configuration read from `path`, with the place of each. Besides the
/// problems of reading it, this opens everything that the settings name, as the server would. If
/// there are no problems, the server starts on this machine, unless reading a whole source finds a
/// problem that opening it does not, or the port is in use. Creates or changes no files.
ConfigFindings check_config(const LoadedConfig& loaded, const std::string& path);

}  // namespace trapeze
