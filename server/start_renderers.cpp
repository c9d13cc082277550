#include "server/start_renderers.h"

#include <spdlog/spdlog.h>

#include <utility>

namespace trapeze {

std::vector<std::unique_ptr<CoverageRenderer>> start_renderers(const RendererOptions& options,
                                                               int count) {
  MadeRenderers made = make_renderers(options, count);
  for (const RendererFailure& failure : made.failures) {
    spdlog::info("not drawing by {}: {}", failure.what, failure.reason);
  }
  const CoverageRenderer& first = *made.renderers.front();
  spdlog::info("drawing by {}: {}, {} worker{}", first.name(), first.description(), count,
               count == 1 ? "" : "s");
  return std::move(made.renderers);
}

}  // namespace trapeze
