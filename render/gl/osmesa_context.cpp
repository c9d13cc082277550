#include "render/gl/osmesa_context.h"

#include <GL/osmesa.h>
#include <dlfcn.h>

#include <array>
#include <stdexcept>
#include <string>

namespace trapeze {
namespace {

constexpr const char* kLibrary = "libOSMesa.so.8";  // as in GL/osmesa.h of all Mesa versions

/// The library, loaded on first use: it loads LLVM, which would take a quarter of the start-up time
/// of every command, and 10 MB of memory.
struct Osmesa {
  decltype(&::OSMesaCreateContextAttribs) create = nullptr;
  decltype(&::OSMesaDestroyContext) destroy = nullptr;
  decltype(&::OSMesaMakeCurrent) make_current = nullptr;
  decltype(&::OSMesaGetProcAddress) address_of = nullptr;

  /// Throws std::runtime_error with the reason. Thread-safe.
  static const Osmesa& get() {
    static const Osmesa loaded;
    return loaded;
  }

 private:
  Osmesa() {
    // Never closed: data that Mesa keeps per thread outlives the contexts.
    void* const library = dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
      const char* const reason = dlerror();
      throw std::runtime_error(std::string(reason != nullptr ? reason : kLibrary) +
                               " (libosmesa6 of Debian has it)");
    }
    load(library, "OSMesaCreateContextAttribs", create);
    load(library, "OSMesaDestroyContext", destroy);
    load(library, "OSMesaMakeCurrent", make_current);
    load(library, "OSMesaGetProcAddress", address_of);
  }

  template <typename Function>
  static void load(void* library, const char* name, Function& function) {
    function = reinterpret_cast<Function>(dlsym(library, name));
    if (function == nullptr) throw std::runtime_error(std::string(kLibrary) + " has no " + name);
  }
};

class OsmesaContext final : public GlContext {
 public:
  explicit OsmesaContext(const ContextCandidate& candidate) : osmesa_(Osmesa::get()) {
    create(nullptr, candidate);
  }

  ~OsmesaContext() override {
    if (context_ != nullptr) osmesa_.destroy(context_);
  }

  void make_current() override {
    if (osmesa_.make_current(context_, pixel_.data(), GL_UNSIGNED_BYTE, 1, 1) != GL_TRUE) {
      throw std::runtime_error("OSMesaMakeCurrent failed");
    }
  }

  void release() noexcept override {
    osmesa_.make_current(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0);
  }

  std::unique_ptr<GlContext> create_shared() override {
    return std::unique_ptr<GlContext>(new OsmesaContext(this));
  }

 private:
  explicit OsmesaContext(OsmesaContext* other) : osmesa_(other->osmesa_) {
    create(other->context_, other->info().candidate);
  }

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
    context_ = osmesa_.create(attributes.data(), share);
    if (context_ == nullptr) {
      throw std::runtime_error("creating an OpenGL 4.3 core context failed");
    }
    try {
      const CurrentContext current(*this);
      inspect(
          [](const char* name) { return GlFunctions::AnyFunction(Osmesa::get().address_of(name)); },
          candidate);
    } catch (...) {
      osmesa_.destroy(context_);
      throw;
    }
  }

  const Osmesa& osmesa_;
  OSMesaContext context_ = nullptr;
  // OSMesa needs a window to draw into; nothing is ever drawn there.
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
