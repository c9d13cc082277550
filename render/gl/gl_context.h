// Headless OpenGL contexts, without a window system: EGL devices, EGL surfaceless, OSMesa.
//
// All are desktop OpenGL 4.3 core or later. EGL's default display is never used: it may look
// for an X server. EGL displays are initialized once and remain so until the process ends, because
// a display is one object for the whole process.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "render/gl/gl_functions.h"

namespace trapeze {

/// The minimum version of OpenGL: 4.3, core profile.
constexpr int kLeastGlMajor = 4;
constexpr int kLeastGlMinor = 3;

enum class ContextPath { egl_device, egl_software_device, egl_surfaceless, osmesa };

/// "EGL device", "EGL software device", "EGL surfaceless" or "OSMesa".
std::string_view name_of(ContextPath path);

/// A context that may be tried; it may turn out not to work.
struct ContextCandidate {
  ContextPath path = ContextPath::egl_surfaceless;
  int device_index = -1;    // index in EGL's own list of devices; -1 if there is no device
  std::string device_name;  // device file, or the driver's name for it; may be empty

  /// For messages, such as "EGL device 0 (/dev/dri/renderD128)".
  std::string text() const;
};

/// A context that was opened.
struct ContextInfo {
  ContextCandidate candidate;
  std::string vendor;
  std::string renderer;
  std::string version;

  /// Whether the CPU does the drawing.
  bool is_software() const;
  /// One line for logs.
  std::string text() const;
};

/// Thread-safety: a context is current on one thread at a time, on any thread; make_current and
/// release must be called on that thread. All contexts of a share group share buffers, textures and
/// programs. A context may be destroyed on any thread while it is not current, and in any order
/// within its group.
class GlContext {
 public:
  virtual ~GlContext() = default;

  /// Throws std::runtime_error if the device is lost or the context is current elsewhere.
  virtual void make_current() = 0;
  virtual void release() noexcept = 0;
  /// Creates another context of the same share group. Throws std::runtime_error.
  virtual std::unique_ptr<GlContext> create_shared() = 0;

  const GlFunctions& gl() const { return gl_; }
  const ContextInfo& info() const { return info_; }

 protected:
  /// Fills gl_ and info_, and throws std::runtime_error unless this is OpenGL 4.3 or later. The
  /// context must be current.
  void inspect(GlFunctions::Lookup lookup, const ContextCandidate& candidate);

 private:
  GlFunctions gl_;
  ContextInfo info_;
};

/// Makes a context current for the duration of a scope.
class CurrentContext {
 public:
  explicit CurrentContext(GlContext& context) : context_(context) { context.make_current(); }
  ~CurrentContext() { context_.release(); }
  CurrentContext(const CurrentContext&) = delete;
  CurrentContext& operator=(const CurrentContext&) = delete;

 private:
  GlContext& context_;
};

}  // namespace trapeze
