// The one GL renderer of a test program.
#pragma once

#include <memory>
#include <string>

#include "render/mask/mask.h"

namespace trapeze::testing {

struct SharedGl {
  std::unique_ptr<MaskRenderer> renderer;  // by EGL or by OSMesa; null if neither works here
  std::string reasons;                     // why not
};

/// Made when first asked for. For one thread.
const SharedGl& shared_gl();

}  // namespace trapeze::testing
