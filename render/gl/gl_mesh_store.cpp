#include "render/gl/gl_mesh_store.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace trapeze {
namespace {

constexpr std::uint32_t kLargestChunk = 1u << 16;  // 2.5 MiB: uploaded within milliseconds
constexpr std::size_t kIntegersPerTrapezoid = 2 * GlMeshStore::kTexelsPerTrapezoid;

void write(const MeshView& mesh, const MeshTrapezoid& trapezoid, std::int32_t* out) {
  const auto put = [&out](std::int32_t a, std::int32_t b) {
    *out++ = a;
    *out++ = b;
  };
  const auto put_point = [&](std::uint32_t vertex) {
    put(mesh.vertices[vertex].x, mesh.vertices[vertex].y);
  };
  put(mesh.vertices[trapezoid.top].y, mesh.vertices[trapezoid.bottom].y);
  for (const std::uint32_t side : {trapezoid.left, trapezoid.right}) {
    put_point(mesh.edges[side].upper);
    put_point(mesh.edges[side].lower);
  }
}

}  // namespace

GlMeshStore::GlMeshStore(const GlFunctions& gl) {
  GLint texels = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  const auto fitting = static_cast<std::uint32_t>(std::max(texels, 0) / kTexelsPerTrapezoid);
  chunk_size_ = std::min(kLargestChunk, fitting);
  if (chunk_size_ == 0) throw std::runtime_error("the GL device has no buffer textures");
}

GlMeshStore::ChunkPointer& GlMeshStore::place(std::uint64_t mesh_id, std::uint32_t index) {
  std::vector<ChunkPointer>& chunks = meshes_[mesh_id];
  if (index >= chunks.size()) chunks.resize(std::size_t{index} + 1);
  return chunks[index];
}

GlMeshStore::ChunkPointer GlMeshStore::chunk(const GlFunctions& gl, const MeshView& mesh,
                                             std::uint32_t index, const void* uploader) {
  // Locked during an upload: other threads that need the same chunk have to wait for it anyway.
  const std::lock_guard lock(mutex_);
  ChunkPointer& chunk = place(mesh.id, index);
  if (!chunk) chunk = upload(gl, mesh, index, uploader);
  return chunk;
}

GLuint GlMeshStore::changing_buffer(const GlFunctions& gl, std::uint64_t mesh_id,
                                    std::uint32_t index) {
  const std::lock_guard lock(mutex_);
  ChunkPointer& chunk = place(mesh_id, index);
  if (!chunk) chunk = make_chunk(gl, chunk_size_, nullptr);
  return chunk->buffer;
}

GlMeshStore::ChunkPointer GlMeshStore::make_chunk(const GlFunctions& gl, std::size_t trapezoids,
                                                  const void* uploader) const {
  const std::shared_ptr<Chunk> chunk(new Chunk{0, 0, uploader},
                                     [released = released_](const Chunk* dead) {
                                       const std::lock_guard lock(released->mutex);
                                       released->buffers.push_back(dead->buffer);
                                       released->textures.push_back(dead->texture);
                                       delete dead;
                                     });
  const std::size_t bytes = trapezoids * kIntegersPerTrapezoid * sizeof(std::int32_t);
  gl.GenBuffers(1, &chunk->buffer);
  gl.BindBuffer(GL_TEXTURE_BUFFER, chunk->buffer);
  gl.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr, GL_STATIC_DRAW);
  gl.GenTextures(1, &chunk->texture);
  gl.BindTexture(GL_TEXTURE_BUFFER, chunk->texture);
  gl.TexBuffer(GL_TEXTURE_BUFFER, GL_RG32I, chunk->buffer);
  if (gl.GetError() != GL_NO_ERROR) {
    gl.BindBuffer(GL_TEXTURE_BUFFER, 0);
    while (gl.GetError() != GL_NO_ERROR) {
    }
    throw std::runtime_error("the GL device has no memory for " + std::to_string(bytes) +
                             " bytes of trapezoids");
  }
  return chunk;
}

GlMeshStore::ChunkPointer GlMeshStore::upload(const GlFunctions& gl, const MeshView& mesh,
                                              std::uint32_t index, const void* uploader) const {
  const std::size_t first = std::size_t{index} * chunk_size_;
  const auto trapezoids = mesh.trapezoids.subspan(
      first, std::min<std::size_t>(chunk_size_, mesh.trapezoids.size() - first));
  const std::size_t bytes = trapezoids.size() * kIntegersPerTrapezoid * sizeof(std::int32_t);
  ChunkPointer chunk = make_chunk(gl, trapezoids.size(), uploader);
  auto* integers = static_cast<std::int32_t*>(
      gl.MapBufferRange(GL_TEXTURE_BUFFER, 0, static_cast<GLsizeiptr>(bytes),
                        GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT));
  bool is_intact = integers != nullptr;
  if (is_intact) {
    for (std::size_t i = 0; i < trapezoids.size(); ++i) {
      write(mesh, trapezoids[i], integers + i * kIntegersPerTrapezoid);
    }
    is_intact = gl.UnmapBuffer(GL_TEXTURE_BUFFER) == GL_TRUE;
  }
  gl.BindBuffer(GL_TEXTURE_BUFFER, 0);
  // Other contexts of the group see the finished data once they bind the buffer.
  gl.Finish();
  if (!is_intact || gl.GetError() != GL_NO_ERROR) {
    throw std::runtime_error("uploading trapezoids to the GL device failed");
  }
  return chunk;
}

void GlMeshStore::forget(std::uint64_t mesh_id) {
  const std::lock_guard lock(mutex_);
  meshes_.erase(mesh_id);
}

void GlMeshStore::forget_uploads(const void* uploader) {
  const std::lock_guard lock(mutex_);
  for (auto& [mesh_id, chunks] : meshes_) {
    for (ChunkPointer& chunk : chunks) {
      if (chunk && chunk->uploader == uploader) chunk.reset();
    }
  }
}

void GlMeshStore::delete_forgotten(const GlFunctions& gl) {
  std::vector<GLuint> buffers;
  std::vector<GLuint> textures;
  {
    const std::lock_guard lock(released_->mutex);
    buffers.swap(released_->buffers);
    textures.swap(released_->textures);
  }
  gl.DeleteTextures(static_cast<GLsizei>(textures.size()), textures.data());
  gl.DeleteBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
}

}  // namespace trapeze
