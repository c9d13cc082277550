// Contexts by OSMesa, which draws in memory and knows no devices.
#pragma once

#include <memory>

#include "render/gl/gl_context.h"

namespace trapeze {

/// Whether this program was built with OSMesa.
bool has_osmesa();

/// Throws std::runtime_error with the reason.
std::unique_ptr<GlContext> open_osmesa_context(const ContextCandidate& candidate);

}  // namespace trapeze
