#include "bench/experiment/screen.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "render/gl/context_search.h"

namespace trapeze::experiment {

Screen::Screen(const std::string& device) {
  const ContextSearch search = use_first_context(
      {.egl = true, .osmesa = false, .device = device}, [this](std::unique_ptr<GlContext> context) {
        {
          const CurrentContext current(*context);
          store_ = std::make_shared<GlMeshStore>(context->gl());
        }
        renderer_ = std::make_unique<GlRenderer>(std::move(context), store_);
      });
  if (search.found) return;
  std::string reasons;
  for (const ContextFailure& failure : search.failures) {
    reasons.append("; ").append(failure.candidate).append(": ").append(failure.reason);
  }
  throw std::runtime_error("the experiment draws through EGL, which does not work here" + reasons);
}

void Screen::send(const MeshView& mesh) {
  const CurrentContext current(context());
  const auto chunks = static_cast<std::uint32_t>(
      (mesh.trapezoids.size() + store_->chunk_size() - 1) / store_->chunk_size());
  for (std::uint32_t i = 0; i < chunks; ++i) store_->chunk(context().gl(), mesh, i, this);
}

void Screen::forget(std::uint64_t mesh_id) {
  store_->forget(mesh_id);
  const CurrentContext current(context());
  store_->delete_forgotten(context().gl());
}

DrawTimes Screen::draw(std::span<const MeshView> meshes, std::span<const Ranges> ranges,
                       const View& view, std::vector<Mask>& masks) {
  masks.resize(meshes.size());
  parts_.clear();
  tasks_.clear();
  for (std::size_t i = 0; i < meshes.size(); ++i) parts_.push_back({meshes[i], ranges[i]});
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    tasks_.push_back({std::span(parts_).subspan(i, 1), view, &masks[i]});
  }
  return renderer_->draw(tasks_);
}

GLuint DeviceTrapezoids::buffer(std::size_t first) {
  return screen_.store().changing_buffer(screen_.context().gl(), mesh_id_,
                                         static_cast<std::uint32_t>(first / chunk_size()));
}

void DeviceTrapezoids::send(const TrapezoidList& trapezoids) {
  const CurrentContext current(screen_.context());
  const GlFunctions& gl = screen_.context().gl();
  for (std::size_t first = 0; first < trapezoids.size(); first += chunk_size()) {
    const std::size_t count = std::min<std::size_t>(trapezoids.size() - first, chunk_size());
    gl.BindBuffer(GL_TEXTURE_BUFFER, buffer(first));
    // Every view ends with reading it back, so the device no longer uses the old contents.
    const std::size_t bytes = count * sizeof(TrapezoidRecord);
    void* room = gl.MapBufferRange(
        GL_TEXTURE_BUFFER, 0, static_cast<GLsizeiptr>(bytes),
        GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_RANGE_BIT | GL_MAP_UNSYNCHRONIZED_BIT);
    if (room == nullptr) throw std::runtime_error("the device gives no access to its memory");
    std::memcpy(room, trapezoids.records.data() + first, bytes);
    gl.UnmapBuffer(GL_TEXTURE_BUFFER);
  }
  gl.Finish();
}

DrawTimes DeviceTrapezoids::draw(std::span<const std::uint32_t> ends, const View& view,
                                 std::vector<Mask>& masks) {
  meshes_.assign(ends.size(), MeshView{mesh_id_, {}, {}, {}});
  ranges_.resize(ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const std::uint32_t begin = i == 0 ? 0 : ends[i - 1];
    ranges_[i].assign(1, {begin, ends[i] - begin});
  }
  return screen_.draw(meshes_, ranges_, view, masks);
}

}  // namespace trapeze::experiment
