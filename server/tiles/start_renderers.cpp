#include "server/tiles/start_renderers.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "core/grid/for_each_in_parallel.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

int renderer_count(unsigned workers) {
  return static_cast<int>(workers == 0 ? std::max(1u, std::thread::hardware_concurrency())
                                       : workers);
}

std::vector<std::unique_ptr<MaskRenderer>> start_renderers(const RendererOptions& options,
                                                           int count) {
  MadeRenderers made = make_renderers(options, count);
  for (const RendererFailure& failure : made.failures) {
    spdlog::info(fmt::format("not rendering with {}: {}", failure.what, failure.reason));
  }
  const MaskRenderer& first = *made.renderers.front();
  spdlog::info(fmt::format("rendering with {}: {}, {} worker{}", first.name(), first.description(),
                           count, count == 1 ? "" : "s"));
  return std::move(made.renderers);
}

void warm_up(std::span<const std::unique_ptr<MaskRenderer>> renderers) {
  // A trapezoid of few pixels and one of many are drawn in different ways.
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<MeshTrapezoid> trapezoids;
  append_box({3, 3, 6, 6}, vertices, edges, trapezoids);
  append_box({20, 20, 220, 220}, vertices, edges, trapezoids);
  const MeshView mesh{new_mesh_id(), vertices, edges, trapezoids};
  const TrapezoidRange all{0, static_cast<std::uint32_t>(trapezoids.size())};
  for_each_in_parallel(renderers.size(), renderers.size(), [&](std::size_t i) {
    Mask mask;
    renderers[i]->draw(mesh, {&all, 1}, View{}, mask);
  });
  for (const auto& renderer : renderers) renderer->forget(mesh.id);
}

}  // namespace trapeze
