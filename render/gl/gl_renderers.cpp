#include "render/gl/gl_renderers.h"

#include <cstdlib>
#include <string>
#include <utility>

#include "render/gl/context_search.h"
#include "render/gl/gl_mesh_store.h"
#include "render/gl/gl_renderer.h"

namespace trapeze {
namespace {

std::vector<std::unique_ptr<MaskRenderer>> renderers_of(std::unique_ptr<GlContext> first,
                                                        int count) {
  std::vector<std::unique_ptr<GlContext>> contexts;
  for (int i = 1; i < count; ++i) contexts.push_back(first->create_shared());
  contexts.push_back(std::move(first));

  std::shared_ptr<GlMeshStore> store;
  {
    const CurrentContext current(*contexts.back());
    store = std::make_shared<GlMeshStore>(contexts.back()->gl());
  }
  std::vector<std::unique_ptr<MaskRenderer>> renderers;
  renderers.reserve(contexts.size());
  for (auto& context : contexts) {
    renderers.push_back(std::make_unique<GlRenderer>(std::move(context), store));
  }
  return renderers;
}

// Without threads of its own, llvmpipe computes on the threads that call it, but on one of them at
// a time. That is best for a few threads: a tile computes for a quarter of its time, and no thread
// has to wake another one, which takes longer than it gains, even with one renderer and pictures of
// 1024 pixels. With more threads, they would wait for each other. The variable is read once, when
// the first context is created.
void choose_llvmpipe_threads(int renderers) {
  constexpr int kFew = 4;
  setenv("LP_NUM_THREADS", renderers <= kFew ? "0" : std::to_string(renderers).c_str(), 0);
}

}  // namespace

GlRenderers make_gl_renderers(const ContextRequest& request, int count) {
  choose_llvmpipe_threads(count);
  GlRenderers made;
  made.failures = use_first_context(request, [&](std::unique_ptr<GlContext> context) {
                    made.renderers = renderers_of(std::move(context), count);
                  }).failures;
  return made;
}

}  // namespace trapeze
