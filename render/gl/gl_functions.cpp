#include "render/gl/gl_functions.h"

#include <stdexcept>
#include <string>

namespace trapeze {

GlFunctions GlFunctions::load(Lookup lookup) {
  GlFunctions gl;
#define TRAPEZE_GL_LOAD(TYPE, NAME)                                  \
  gl.NAME = reinterpret_cast<PFNGL##TYPE##PROC>(lookup("gl" #NAME)); \
  if (gl.NAME == nullptr) throw std::runtime_error("OpenGL function gl" #NAME " is missing");
  TRAPEZE_GL_FUNCTIONS(TRAPEZE_GL_LOAD)
#undef TRAPEZE_GL_LOAD
  return gl;
}

}  // namespace trapeze
