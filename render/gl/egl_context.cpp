#include "render/gl/egl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <string_view>

namespace trapeze {
namespace {

// Whether a space-separated list of extensions contains that one.
bool has_extension(const char* extensions, std::string_view name) {
  if (extensions == nullptr) return false;
  std::string_view rest(extensions);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    if (rest.substr(0, end) == name) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

std::string_view egl_error_name(EGLint error) {
  switch (error) {
    case EGL_SUCCESS:
      return "no error given";
    case EGL_NOT_INITIALIZED:
      return "not initialized (missing driver or permission)";
    case EGL_BAD_ACCESS:
      return "access denied, or current on another thread";
    case EGL_BAD_ALLOC:
      return "out of resources";
    case EGL_BAD_ATTRIBUTE:
      return "bad attribute";
    case EGL_BAD_CONFIG:
      return "bad configuration";
    case EGL_BAD_CONTEXT:
      return "bad context";
    case EGL_BAD_DISPLAY:
      return "bad display";
    case EGL_BAD_MATCH:
      return "no such kind of context";
    case EGL_BAD_PARAMETER:
      return "bad parameter";
    case EGL_CONTEXT_LOST:
      return "context lost";
    default:
      return "unknown error";
  }
}

[[noreturn]] void throw_egl_error(std::string_view what) {
  const EGLint error = eglGetError();
  std::array<char, 16> code{};
  std::snprintf(code.data(), code.size(), "0x%04X", static_cast<unsigned>(error));
  throw std::runtime_error(std::string(what) + " failed: " + std::string(egl_error_name(error)) +
                           " (" + code.data() + ")");
}

template <typename Function>
Function egl_function(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

std::vector<EGLDeviceEXT> query_egl_devices() {
  const auto query = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  EGLint count = 0;
  if (query == nullptr || query(0, nullptr, &count) != EGL_TRUE || count <= 0) return {};
  std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
  if (query(count, devices.data(), &count) != EGL_TRUE || count < 0) return {};
  devices.resize(static_cast<std::size_t>(count));
  return devices;
}

std::string name_of_device(EGLDeviceEXT device, const char* extensions) {
  const auto query = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  if (has_extension(extensions, "EGL_EXT_device_drm_render_node")) {
    if (const char* file = query(device, EGL_DRM_RENDER_NODE_FILE_EXT)) return file;
  }
  if (has_extension(extensions, "EGL_EXT_device_drm")) {
    if (const char* file = query(device, EGL_DRM_DEVICE_FILE_EXT)) return file;
  }
  if (has_extension(extensions, "EGL_EXT_device_query_name")) {
    if (const char* name = query(device, EGL_RENDERER_EXT)) return name;
  }
  return {};
}

EGLDisplay display_of(const ContextCandidate& candidate) {
  const auto get_display =
      egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  if (get_display == nullptr) throw std::runtime_error("EGL has no platform displays");
  if (candidate.path == ContextPath::egl_surfaceless) {
    if (!has_extension(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS),
                       "EGL_MESA_platform_surfaceless")) {
      throw std::runtime_error("EGL_MESA_platform_surfaceless is missing");
    }
    return get_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  }
  const std::vector<EGLDeviceEXT> devices = query_egl_devices();
  const auto index = static_cast<std::size_t>(candidate.device_index);
  if (candidate.device_index < 0 || index >= devices.size()) {
    throw std::runtime_error("there is no such device");
  }
  return get_display(EGL_PLATFORM_DEVICE_EXT, devices[index], nullptr);
}

// An EGL context without a surface: the renderer draws into buffers of its own.
class EglContext final : public GlContext {
 public:
  explicit EglContext(const ContextCandidate& candidate) : display_(display_of(candidate)) {
    if (display_ == EGL_NO_DISPLAY) throw_egl_error("opening the display");
    EGLint major = 0;
    EGLint minor = 0;
    if (eglInitialize(display_, &major, &minor) != EGL_TRUE) throw_egl_error("eglInitialize");
    const char* extensions = eglQueryString(display_, EGL_EXTENSIONS);
    if (!has_extension(extensions, "EGL_KHR_surfaceless_context") ||
        !has_extension(extensions, "EGL_KHR_create_context")) {
      throw std::runtime_error("the display cannot make contexts without a surface");
    }
    config_ = choose_config(extensions);
    create(EGL_NO_CONTEXT, candidate);
  }

  ~EglContext() override {
    if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  }

  void make_current() override {
    eglBindAPI(EGL_OPENGL_API);  // a setting per thread
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE) {
      throw_egl_error("eglMakeCurrent");
    }
  }

  void release() noexcept override {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }

  std::unique_ptr<GlContext> create_shared() override {
    return std::unique_ptr<GlContext>(new EglContext(this));
  }

 private:
  explicit EglContext(EglContext* other) : display_(other->display_), config_(other->config_) {
    create(other->context_, other->info().candidate);
  }

  EGLConfig choose_config(const char* extensions) const {
    if (has_extension(extensions, "EGL_KHR_no_config_context")) return EGL_NO_CONFIG_KHR;
    const std::array<EGLint, 5> wanted{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0,
                                       EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (eglChooseConfig(display_, wanted.data(), &config, 1, &count) != EGL_TRUE) {
      throw_egl_error("eglChooseConfig");
    }
    if (count == 0) throw std::runtime_error("the display has no configuration for OpenGL");
    return config;
  }

  void create(EGLContext share, const ContextCandidate& candidate) {
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) throw_egl_error("choosing desktop OpenGL");
    const std::array<EGLint, 7> attributes{EGL_CONTEXT_MAJOR_VERSION_KHR,
                                           kLeastGlMajor,
                                           EGL_CONTEXT_MINOR_VERSION_KHR,
                                           kLeastGlMinor,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK_KHR,
                                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT_KHR,
                                           EGL_NONE};
    context_ = eglCreateContext(display_, config_, share, attributes.data());
    if (context_ == EGL_NO_CONTEXT) throw_egl_error("creating an OpenGL 4.3 core context");
    try {
      const CurrentContext current(*this);
      inspect([](const char* name) { return GlFunctions::AnyFunction(eglGetProcAddress(name)); },
              candidate);
    } catch (...) {
      eglDestroyContext(display_, context_);
      throw;
    }
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLConfig config_ = nullptr;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::vector<ContextCandidate> list_egl_candidates() {
  std::vector<ContextCandidate> candidates;
  const auto query = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  if (query != nullptr) {
    const std::vector<EGLDeviceEXT> devices = query_egl_devices();
    for (std::size_t i = 0; i < devices.size(); ++i) {
      const char* extensions = query(devices[i], EGL_EXTENSIONS);
      const bool is_software = has_extension(extensions, "EGL_MESA_device_software");
      candidates.push_back(
          {is_software ? ContextPath::egl_software_device : ContextPath::egl_device,
           static_cast<int>(i), name_of_device(devices[i], extensions)});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.path < b.path; });
  candidates.push_back({ContextPath::egl_surfaceless, -1, {}});
  return candidates;
}

std::unique_ptr<GlContext> open_egl_context(const ContextCandidate& candidate) {
  return std::make_unique<EglContext>(candidate);
}

}  // namespace trapeze
