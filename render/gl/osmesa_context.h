// Contexts by OSMesa, which draws in memory and knows no devices. Its library is loaded when the
// first one is opened.
#pragma once

#include <memory>

#include "render/gl/gl_context.h"

namespace trapeze {

/// Whether this program was built to draw by OSMesa. Its library may be missing all the same.
bool has_osmesa();

/// Throws std::runtime_error with the reason.
std::unique_ptr<GlContext> open_osmesa_context(const ContextCandidate& candidate);

}  // namespace trapeze
