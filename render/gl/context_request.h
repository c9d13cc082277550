// Which contexts are wanted, and why one was not taken. Needs no OpenGL.
#pragma once

#include <string>

namespace trapeze {

struct ContextRequest {
  bool egl = true;
  bool osmesa = true;
  /// The device to prefer: its index in EGL's list, or a part of its name or of the renderer's
  /// name, in any case. Empty: no preference. A device that is preferred but does not work is
  /// reported, and the others are tried.
  std::string device;
};

/// One candidate and why it was not taken.
struct ContextFailure {
  std::string candidate;
  std::string reason;
};

}  // namespace trapeze
