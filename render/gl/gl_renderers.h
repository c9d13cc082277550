// Renderers by GL, if there is a context for them. Needs no OpenGL where this is included.
#pragma once

#include <memory>
#include <vector>

#include "render/gl/context_request.h"
#include "render/mask/mask.h"

namespace trapeze {

struct GlRenderers {
  std::vector<std::unique_ptr<MaskRenderer>> renderers;  // none if no context works here
  std::vector<ContextFailure> failures;                  // what was tried before
};

/// Makes `count` renderers with one store of meshes, one for each thread that draws. Never throws
/// because of a context: the reasons are kept.
GlRenderers make_gl_renderers(const ContextRequest& request, int count);

}  // namespace trapeze
