// Makes renderers by GL, if a context works. This header includes none of OpenGL's.
#pragma once

#include <memory>
#include <vector>

#include "render/gl/context_request.h"
#include "render/mask/mask.h"

namespace trapeze {

struct GlRenderers {
  std::vector<std::unique_ptr<MaskRenderer>> renderers;  // none if no context works here
  std::vector<ContextFailure> failures;                  // the contexts tried before
};

/// Makes `count` renderers that share one store of meshes, one for each thread that draws. Contexts
/// that do not work are listed with their reasons; nothing is thrown because of them.
GlRenderers make_gl_renderers(const ContextRequest& request, int count);

}  // namespace trapeze
