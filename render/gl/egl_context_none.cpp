// Replaces egl_context.cpp in builds without EGL.
#include <stdexcept>

#include "render/gl/egl_context.h"

namespace trapeze {

std::vector<ContextCandidate> list_egl_candidates() {
  return {};
}

std::unique_ptr<GlContext> open_egl_context(const ContextCandidate&) {
  throw std::runtime_error("this program was built without EGL");
}

}  // namespace trapeze
