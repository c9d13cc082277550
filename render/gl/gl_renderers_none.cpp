// Replaces all other sources of this folder in builds with neither EGL nor OSMesa.
#include "render/gl/gl_renderers.h"

namespace trapeze {

GlRenderers make_gl_renderers(const ContextRequest& request, int) {
  GlRenderers none;
  if (request.egl) none.failures.push_back({"EGL", "this program was built without EGL"});
  if (request.osmesa) none.failures.push_back({"OSMesa", "this program was built without OSMesa"});
  return none;
}

}  // namespace trapeze
