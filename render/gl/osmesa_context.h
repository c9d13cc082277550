// OSMesa contexts, which draw in memory and use no device. The library is loaded when the first one
// is opened.
#pragma once

#include <memory>

#include "render/gl/gl_context.h"

namespace trapeze {

/// Whether this program was built with OSMesa support. The library may still be missing.
bool has_osmesa();

/// Throws std::runtime_error with the reason.
std::unique_ptr<GlContext> open_osmesa_context(const ContextCandidate& candidate);

}  // namespace trapeze
