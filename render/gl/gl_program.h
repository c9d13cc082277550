// Programs of one compute shader.
#pragma once

#include <string>

#include "render/gl/gl_functions.h"

namespace trapeze {

/// Compiles and links; a context is current. Throws std::runtime_error, with what the device says,
/// if it does not take the source.
GLuint make_compute_program(const GlFunctions& gl, const std::string& source);

}  // namespace trapeze
