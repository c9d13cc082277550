// What SIGINT and SIGTERM do to commands that write files.
#pragma once

namespace trapeze {

/// From here on SIGINT and SIGTERM remove what the process has not finished writing, say so, and
/// end it with 130 or 143. A signal that is ignored stays so. To be called once, before there are
/// other threads.
void end_cleanly_when_interrupted();

}  // namespace trapeze
