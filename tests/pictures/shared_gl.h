// The single GL renderer of a test program.
#pragma once

#include <memory>
#include <string>

#include "render/mask/mask.h"

namespace trapeze::testing {

struct SharedGl {
  std::unique_ptr<MaskRenderer> renderer;  // with EGL or OSMesa; null if neither works here
  std::string reasons;                     // why there is no renderer
};

/// Created on first use. For use by one thread.
const SharedGl& shared_gl();

}  // namespace trapeze::testing
