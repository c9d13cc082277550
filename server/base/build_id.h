// Identifies the program.
#pragma once

#include <string>

namespace trapeze {

/// The version of the project, "0.1.0".
std::string version();

/// Identifies the machine code that is running, so that data made by another build is not mistaken
/// for what this one would make. Never empty.
const std::string& build_id();

}  // namespace trapeze
