#include "bench/experiment/screen.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

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
  for (std::uint32_t i = 0; i < chunks; ++i) store_->chunk(context().gl(), mesh, i);
}

void Screen::forget(const MeshView& mesh) {
  store_->forget(mesh.id);
  const CurrentContext current(context());
  store_->delete_forgotten(context().gl());
}

MeshView DeviceTrapezoids::mesh() const { return {mesh_id_, vertices_, edges_, trapezoids_}; }

void DeviceTrapezoids::reserve(std::size_t count) {
  const std::size_t chunks = std::max<std::size_t>(1, (count + chunk_size() - 1) / chunk_size());
  if (trapezoids_.size() < chunks * chunk_size()) trapezoids_.resize(chunks * chunk_size());
}

GLuint DeviceTrapezoids::chunk_buffer(std::uint32_t chunk) {
  return screen_.store().chunk(screen_.context().gl(), mesh(), chunk)->buffer;
}

void DeviceTrapezoids::send(std::span<const TrapezoidRecord> records) {
  const CurrentContext current(screen_.context());
  const GlFunctions& gl = screen_.context().gl();
  reserve(records.size());
  for (std::uint32_t chunk = 0; !records.empty(); ++chunk) {
    const auto part = records.first(std::min<std::size_t>(records.size(), chunk_size()));
    records = records.subspan(part.size());
    gl.BindBuffer(GL_TEXTURE_BUFFER, chunk_buffer(chunk));
    // Every view ends with reading it back, so the device is done with what was there.
    void* room = gl.MapBufferRange(
        GL_TEXTURE_BUFFER, 0, static_cast<GLsizeiptr>(part.size_bytes()),
        GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_RANGE_BIT | GL_MAP_UNSYNCHRONIZED_BIT);
    if (room == nullptr) throw std::runtime_error("the device gives no access to its memory");
    std::memcpy(room, part.data(), part.size_bytes());
    gl.UnmapBuffer(GL_TEXTURE_BUFFER);
  }
  gl.Finish();
}

void DeviceTrapezoids::draw(std::size_t count, const View& view, Coverage& out) {
  const TrapezoidRange range{0, static_cast<std::uint32_t>(count)};
  const std::size_t ranges = count == 0 ? 0 : 1;
  screen_.renderer().draw(mesh(), std::span(&range, ranges), view, out);
}

}  // namespace trapeze::experiment
