// EGL contexts: devices, and surfaceless.
#pragma once

#include <memory>
#include <vector>

#include "render/gl/gl_context.h"

namespace trapeze {

/// The EGL candidates, best first; none without EGL.
std::vector<ContextCandidate> list_egl_candidates();

/// Opens one of these candidates. Throws std::runtime_error with the reason.
std::unique_ptr<GlContext> open_egl_context(const ContextCandidate& candidate);

}  // namespace trapeze
