// Which contexts are requested, and why one was not used. Needs no OpenGL.
#pragma once

#include <string>

namespace trapeze {

struct ContextRequest {
  bool egl = true;
  bool osmesa = true;
  /// The device to prefer: its index in EGL's list, or a part of its name or of the renderer's
  /// name, ignoring case. Empty: no preference. If the preferred device does not work, that is
  /// reported, and the others are tried.
  std::string device;
};

/// A candidate and the reason why it was not used.
struct ContextFailure {
  std::string candidate;
  std::string reason;
};

}  // namespace trapeze
