#include "render/make_renderer.h"

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

#include "render/gl/gl_context.h"
#include "render/gl/gl_mesh_store.h"
#include "render/gl/gl_renderer.h"
#include "render/software/software_renderer.h"

namespace trapeze {
namespace {

using Renderers = std::vector<std::unique_ptr<CoverageRenderer>>;

Renderers make_software_renderers(int count) {
  Renderers renderers;
  for (int i = 0; i < count; ++i) renderers.push_back(std::make_unique<SoftwareRenderer>());
  return renderers;
}

Renderers make_gl_renderers(std::unique_ptr<GlContext> first, int count) {
  std::vector<std::unique_ptr<GlContext>> contexts;
  for (int i = 1; i < count; ++i) contexts.push_back(first->create_shared());
  contexts.push_back(std::move(first));

  std::shared_ptr<GlMeshStore> store;
  {
    const CurrentContext current(*contexts.back());
    store = std::make_shared<GlMeshStore>(contexts.back()->gl());
  }
  Renderers renderers;
  for (auto& context : contexts) {
    renderers.push_back(std::make_unique<GlRenderer>(std::move(context), store));
  }
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

// Without threads of its own llvmpipe computes on those that ask it to, but on one of them at a
// time. That is best for a few: a tile computes for a fifth of its time, and no thread has to wake
// another. More would wait for each other. It reads this once, when the first context is made.
void choose_llvmpipe_threads(int renderers) {
  constexpr int kFew = 4;
  if (renderers == 1) return;
  setenv("LP_NUM_THREADS", renderers <= kFew ? "0" : std::to_string(renderers).c_str(), 0);
}

}  // namespace

std::optional<RendererKind> renderer_kind_from(std::string_view word) {
  if (word == "auto") return RendererKind::automatic;
  if (word == "egl") return RendererKind::egl;
  if (word == "osmesa") return RendererKind::osmesa;
  if (word == "software") return RendererKind::software;
  return std::nullopt;
}

MadeRenderers make_renderers(const RendererOptions& options, int count) {
  if (count < 1) throw std::invalid_argument("at least one renderer is needed");
  MadeRenderers made;
  if (options.kind == RendererKind::software) {
    made.renderers = make_software_renderers(count);
    return made;
  }

  choose_llvmpipe_threads(count);
  ContextSearch search = use_first_context({.egl = options.kind != RendererKind::osmesa,
                                            .osmesa = options.kind != RendererKind::egl,
                                            .device = options.device},
                                           [&](std::unique_ptr<GlContext> context) {
                                             made.renderers =
                                                 make_gl_renderers(std::move(context), count);
                                           });
  for (ContextFailure& failure : search.failures) {
    made.failures.push_back({std::move(failure.candidate), std::move(failure.reason)});
  }
  if (search.found) return made;
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
