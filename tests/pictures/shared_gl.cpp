#include "tests/pictures/shared_gl.h"

#include <utility>

#include "render/make_renderer.h"

namespace trapeze::testing {
namespace {

SharedGl make_gl() {
  MadeRenderer made = make_renderer();
  if (made.renderer->name() != "software") return {std::move(made.renderer), {}};
  SharedGl none;
  for (const RendererFailure& f : made.failures) none.reasons += f.what + ": " + f.reason + "; ";
  return none;
}

}  // namespace

const SharedGl& shared_gl() {
  static const SharedGl gl = make_gl();
  return gl;
}

}  // namespace trapeze::testing
