// Runs a command of the operator's.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace trapeze {

/// Runs it by /bin/sh with that text as its input and these variables beside those of this process,
/// and waits for its end; what it prints goes where the log goes. Its exit status, or 128 and the
/// number of the signal that ended it. As soon as `is_stopping` it is told to end by SIGTERM, with
/// all that it has started, and killed a second later. Throws std::system_error if it cannot be
/// started. Any thread.
int run_command(const std::string& command,
                const std::vector<std::pair<std::string, std::string>>& variables,
                const std::string& input, const std::function<bool()>& is_stopping);

}  // namespace trapeze
