// Compiles GL programs with a single compute shader.
#pragma once

#include <string>

#include "render/gl/gl_functions.h"

namespace trapeze {

/// Compiles and links a program. A context must be current. Throws std::runtime_error with the
/// driver's message if that fails.
GLuint make_compute_program(const GlFunctions& gl, const std::string& source);

}  // namespace trapeze
