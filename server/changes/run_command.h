// Runs a command configured by the operator.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace trapeze {

/// Runs it with /bin/sh, with that text as its input and these variables in addition to the
/// environment of this process, and waits for it to finish. Its output goes to standard error, like
/// the log. Returns its exit status, or 128 plus the number of the signal that ended it. As soon as
/// `is_stopping` returns true, SIGTERM is sent to the command and all processes it has started, and
/// SIGKILL a second later. Throws std::system_error if it cannot be started. Any thread.
int run_command(const std::string& command,
                const std::vector<std::pair<std::string, std::string>>& variables,
                const std::string& input, const std::function<bool()>& is_stopping);

}  // namespace trapeze
