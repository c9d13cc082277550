// Handling of SIGINT and SIGTERM in commands that write files.
#pragma once

namespace trapeze {

/// From here on SIGINT and SIGTERM delete unfinished files, print a message and end the process
/// with status 130 or 143. Signals that are ignored stay ignored. Call it once, before other
/// threads exist.
void end_cleanly_when_interrupted();

}  // namespace trapeze
