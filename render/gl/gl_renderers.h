// Creates GL renderers, if a context works. This header includes no OpenGL headers.
#pragma once

#include <memory>
#include <vector>

#include "render/gl/context_request.h"
#include "render/mask/mask.h"

namespace trapeze {

struct GlRenderers {
  std::vector<std::unique_ptr<MaskRenderer>> renderers;  // empty if no context works here
  std::vector<ContextFailure> failures;                  // the contexts tried before
};

/// Creates `count` renderers that share one store of meshes, one for each drawing thread. Contexts
/// that do not work are listed with their reasons instead of throwing.
GlRenderers make_gl_renderers(const ContextRequest& request, int count);

}  // namespace trapeze
