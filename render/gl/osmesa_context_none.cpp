// Replaces osmesa_context.cpp in builds without OSMesa.
#include <stdexcept>

#include "render/gl/osmesa_context.h"

namespace trapeze {

bool has_osmesa() {
  return false;
}

std::unique_ptr<GlContext> open_osmesa_context(const ContextCandidate&) {
  throw std::runtime_error("this program was built without OSMesa");
}

}  // namespace trapeze
