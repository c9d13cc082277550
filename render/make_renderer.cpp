#include "render/make_renderer.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "render/gl/gl_renderers.h"
#include "render/software/software_renderer.h"

namespace trapeze {
namespace {

using Renderers = std::vector<std::unique_ptr<MaskRenderer>>;

Renderers make_software_renderers(int count) {
  Renderers renderers;
  for (int i = 0; i < count; ++i) renderers.push_back(std::make_unique<SoftwareRenderer>());
  return renderers;
}

std::string join(const std::vector<RendererFailure>& failures) {
  std::string text;
  for (const RendererFailure& failure : failures) {
    if (!text.empty()) text += "; ";
    text.append(failure.what).append(": ").append(failure.reason);
  }
  return text;
}

}  // namespace

MadeRenderers make_renderers(const RendererOptions& options, int count) {
  if (count < 1) throw std::invalid_argument("at least one renderer is needed");
  MadeRenderers made;
  if (options.kind == RendererKind::software) {
    made.renderers = make_software_renderers(count);
    return made;
  }

  GlRenderers by_gl = make_gl_renderers({.egl = options.kind != RendererKind::osmesa,
                                         .osmesa = options.kind != RendererKind::egl,
                                         .device = options.device},
                                        count);
  for (ContextFailure& failure : by_gl.failures) {
    made.failures.push_back({std::move(failure.candidate), std::move(failure.reason)});
  }
  if (!by_gl.renderers.empty()) {
    made.renderers = std::move(by_gl.renderers);
    return made;
  }
  if (options.kind != RendererKind::automatic) {
    throw std::runtime_error("no OpenGL context to draw with: " + join(made.failures));
  }
  made.renderers = make_software_renderers(count);
  return made;
}

MadeRenderer make_renderer(const RendererOptions& options) {
  MadeRenderers made = make_renderers(options, 1);
  return {std::move(made.renderers.front()), std::move(made.failures)};
}

}  // namespace trapeze
