#include "render/gl/osmesa_context.h"

#include <GL/osmesa.h>

#include <array>
#include <stdexcept>

namespace trapeze {
namespace {

class OsmesaContext final : public GlContext {
 public:
  explicit OsmesaContext(const ContextCandidate& candidate) { create(nullptr, candidate); }

  ~OsmesaContext() override {
    if (context_ != nullptr) OSMesaDestroyContext(context_);
  }

  void make_current() override {
    if (OSMesaMakeCurrent(context_, pixel_.data(), GL_UNSIGNED_BYTE, 1, 1) != GL_TRUE) {
      throw std::runtime_error("OSMesaMakeCurrent failed");
    }
  }

  void release() noexcept override { OSMesaMakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }

  std::unique_ptr<GlContext> create_shared() override {
    return std::unique_ptr<GlContext>(new OsmesaContext(this));
  }

 private:
  explicit OsmesaContext(OsmesaContext* other) { create(other->context_, other->info().candidate); }

  void create(OSMesaContext share, const ContextCandidate& candidate) {
    const std::array<int, 9> attributes{OSMESA_FORMAT,
                                        OSMESA_RGBA,
                                        OSMESA_PROFILE,
                                        OSMESA_CORE_PROFILE,
                                        OSMESA_CONTEXT_MAJOR_VERSION,
                                        kLeastGlMajor,
                                        OSMESA_CONTEXT_MINOR_VERSION,
                                        kLeastGlMinor,
                                        0};
    context_ = OSMesaCreateContextAttribs(attributes.data(), share);
    if (context_ == nullptr) {
      throw std::runtime_error("creating an OpenGL 4.3 core context failed");
    }
    try {
      const CurrentContext current(*this);
      inspect([](const char* name) { return GlFunctions::AnyFunction(OSMesaGetProcAddress(name)); },
              candidate);
    } catch (...) {
      OSMesaDestroyContext(context_);
      throw;
    }
  }

  OSMesaContext context_ = nullptr;
  // OSMesa wants a window to draw into; nothing is ever drawn there.
  std::array<unsigned char, 4> pixel_{};
};

}  // namespace

bool has_osmesa() {
  return true;
}

std::unique_ptr<GlContext> open_osmesa_context(const ContextCandidate& candidate) {
  return std::make_unique<OsmesaContext>(candidate);
}

}  // namespace trapeze
