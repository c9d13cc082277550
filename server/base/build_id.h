// Which program this is.
#pragma once

#include <string>

namespace trapeze {

/// The version of the project, "0.1.0".
std::string version();

/// Identifies the machine code that runs, so that what another build made is not mistaken for what
/// this one would make. Never empty.
const std::string& build_id();

}  // namespace trapeze
