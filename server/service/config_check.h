// Whether a server would start with a configuration.
#pragma once

#include <string>
#include <vector>

#include "server/config/load_config.h"

namespace trapeze {

struct ConfigFindings {
  std::vector<ConfigProblem> problems;  // the server does not start
  std::vector<ConfigProblem> warnings;  // it starts, and its log warns of the same
};

/// Finds all that is wrong with a configuration, which was read from `path`, each with its place:
/// besides the problems of reading it, what its settings name is opened, as the server would. Where
/// there are no problems, the server starts on this machine, unless reading all of a source finds
/// something that opening it does not, or its port is taken. No file is made or changed.
ConfigFindings check_config(const LoadedConfig& loaded, const std::string& path);

}  // namespace trapeze
