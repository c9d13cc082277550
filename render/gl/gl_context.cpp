#include "render/gl/gl_context.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace trapeze {
namespace {

std::string text_or_empty(const void* text) {
  return text == nullptr ? std::string() : std::string(static_cast<const char*>(text));
}

}  // namespace

std::string_view name_of(ContextPath path) {
  switch (path) {
    case ContextPath::egl_device:
      return "EGL device";
    case ContextPath::egl_software_device:
      return "EGL software device";
    case ContextPath::egl_surfaceless:
      return "EGL surfaceless";
    case ContextPath::osmesa:
      return "OSMesa";
  }
  return "unknown";
}

std::string ContextCandidate::text() const {
  std::string text(name_of(path));
  if (device_index >= 0) text.append(" ").append(std::to_string(device_index));
  if (!device_name.empty()) text.append(" (").append(device_name).append(")");
  return text;
}

bool ContextInfo::is_software() const {
  const std::array<std::string_view, 3> names{"llvmpipe", "softpipe", "swrast"};
  return std::any_of(names.begin(), names.end(), [this](std::string_view name) {
    return renderer.find(name) != std::string::npos;
  });
}

std::string ContextInfo::text() const {
  return candidate.text() + ": " + renderer + " by " + vendor + ", OpenGL " + version;
}

void GlContext::inspect(GlFunctions::Lookup lookup, const ContextCandidate& candidate) {
  gl_ = GlFunctions::load(lookup);
  info_ = {candidate, text_or_empty(gl_.GetString(GL_VENDOR)),
           text_or_empty(gl_.GetString(GL_RENDERER)), text_or_empty(gl_.GetString(GL_VERSION))};
  GLint major = 0;
  GLint minor = 0;
  gl_.GetIntegerv(GL_MAJOR_VERSION, &major);
  gl_.GetIntegerv(GL_MINOR_VERSION, &minor);
  if (major < kLeastGlMajor || (major == kLeastGlMajor && minor < kLeastGlMinor)) {
    throw std::runtime_error("OpenGL 4.3 is needed, \"" + info_.renderer + "\" has " +
                             info_.version);
  }
}

}  // namespace trapeze
