// The trapezoids of meshes in the memory of a GL device, uploaded once for a whole share group.
//
// A trapezoid is stored with its own copy of the ten integers that define it (the y of its top and
// bottom, both ends of both sides): 40 bytes, read from one place; three indexed arrays would need
// about 30 bytes and four dependent reads. Meshes are divided into chunks of equal numbers of
// trapezoids, which are uploaded when they are first drawn. So indices fit into 32 bits, and
// buffers into the limits of the device, however large the mesh is.
//
// Thread-safety: all functions may be called from all threads; those with a parameter `gl` need a
// context of the share group current on the calling thread.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "core/mesh/trapezoid_mesh.h"
#include "render/gl/gl_functions.h"

namespace trapeze {

class GlMeshStore {
 public:
  static constexpr int kTexelsPerTrapezoid = 5;  // each of two 32-bit integers

  struct Chunk {
    GLuint buffer = 0;
    GLuint texture = 0;  // a buffer texture, GL_RG32I
    const void* uploader = nullptr;
  };
  using ChunkPointer = std::shared_ptr<const Chunk>;

  explicit GlMeshStore(const GlFunctions& gl);

  /// Trapezoids per chunk: chunk i begins at trapezoid i * chunk_size().
  std::uint32_t chunk_size() const { return chunk_size_; }

  /// The chunk with that index, usable in any context of the share group; uploaded on behalf of
  /// `uploader` if it has not been uploaded yet. Throws std::runtime_error if the device is out of
  /// memory.
  ChunkPointer chunk(const GlFunctions& gl, const MeshView& mesh, std::uint32_t index,
                     const void* uploader);

  /// The buffer of that chunk of a mesh with changing contents: it has room for chunk_size()
  /// trapezoids, which the caller writes. No thread may draw from it meanwhile; later draws find
  /// the chunk under the id. Throws like chunk().
  GLuint changing_buffer(const GlFunctions& gl, std::uint64_t mesh_id, std::uint32_t index);

  /// Releases the chunks of a mesh; a draw in progress keeps those that it uses.
  void forget(std::uint64_t mesh_id);

  /// Releases the chunks that were uploaded on behalf of `uploader`, in the same way. The next draw
  /// that needs one of them uploads it again.
  void forget_uploads(const void* uploader);

  /// Deletes the buffers and textures of released chunks.
  void delete_forgotten(const GlFunctions& gl);

 private:
  // GL names of chunks that are no longer used, until a thread with a context deletes them.
  struct Released {
    std::mutex mutex;
    std::vector<GLuint> buffers;
    std::vector<GLuint> textures;
  };

  ChunkPointer& place(std::uint64_t mesh_id, std::uint32_t index);
  ChunkPointer make_chunk(const GlFunctions& gl, std::size_t trapezoids,
                          const void* uploader) const;
  ChunkPointer upload(const GlFunctions& gl, const MeshView& mesh, std::uint32_t index,
                      const void* uploader) const;

  std::uint32_t chunk_size_ = 0;
  std::shared_ptr<Released> released_ = std::make_shared<Released>();
  std::mutex mutex_;
  std::unordered_map<std::uint64_t, std::vector<ChunkPointer>> meshes_;  // by MeshView::id
};

}  // namespace trapeze
