// Draws masks with OpenGL: exact area, not multisampling. See gl_shader.h for the method.
//
// A compute shader adds up areas as integers in a buffer. The buffer is read back, and its rows are
// summed and rounded to 8 bits on the CPU. Rasterizing strips and points with additive blending
// gives the same masks, but takes a software device ten times as long per trapezoid.
//
// On a GPU, tasks are drawn in batches: they share one buffer, so that the fixed cost of a pass,
// which is most of the cost of a light tile, is paid once for all. A software device draws one task
// per pass: passes are cheap there, and the differences of one picture stay in the cache.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/gl/gl_context.h"
#include "render/gl/gl_mesh_store.h"
#include "render/mask/mask.h"

namespace trapeze {

/// The context is current only during draw(), so different threads may use the renderer one after
/// the other.
class GlRenderer final : public MaskRenderer {
 public:
  /// `store` must be that of the context's share group. Throws std::runtime_error if the device
  /// lacks something that the renderer needs.
  GlRenderer(std::unique_ptr<GlContext> context, std::shared_ptr<GlMeshStore> store);
  ~GlRenderer() override;
  GlRenderer(const GlRenderer&) = delete;
  GlRenderer& operator=(const GlRenderer&) = delete;

  using MaskRenderer::draw;
  DrawTimes draw(std::span<const MaskTask> tasks) override;
  bool gains_by_batching() const override { return gains_by_batching_; }
  /// Whether tasks are drawn in batches; the default depends on the device.
  void set_batching(bool gains) { gains_by_batching_ = gains; }
  void release_memory() override;
  void forget(std::uint64_t mesh_id) override { store_->forget(mesh_id); }
  std::string_view name() const override;
  std::string description() const override { return context_->info().text(); }

  GlContext& context() { return *context_; }

 private:
  struct Program {
    GLuint name = 0;
    GLint first = -1;
    GLint count = -1;
    GLint origin = -1;
    GLint pixels_per_cell = -1;
    GLint first_row = -1;
    GLint size = -1;
    GLint place = -1;
  };

  // Consecutive rows of a picture; all rows if the buffer has room.
  struct Band {
    const MaskTask* task = nullptr;
    int first_row = 0;
    int rows = 0;
    std::size_t place = 0;  // of its first pixel in the buffer

    std::size_t pixels() const {
      return static_cast<std::size_t>(task->view.width) * static_cast<std::size_t>(rows);
    }
  };

  // A range of indices_ that is drawn by one dispatch: trapezoids of one chunk of a mesh.
  struct Batch {
    std::size_t band = 0;
    std::uint64_t mesh_id = 0;
    std::uint32_t number = 0;  // of the chunk
    GlMeshStore::ChunkPointer chunk;
    std::size_t first = 0;
    std::size_t count = 0;
  };

  Program make_program();
  void delete_objects() noexcept;
  void release_device_memory();
  void draw_task(const MaskTask& task, DrawTimes& times);
  void draw_band(Band band, DrawTimes& times);
  void choose(const MeshView& mesh, std::uint32_t number, std::uint32_t first, std::uint32_t count,
              DrawTimes& times);
  void run_pass(DrawTimes& times);
  void unmap();
  void finish_pass(DrawTimes& times);
  void set_last_band_aside(DrawTimes& times);
  void prepare_buffers();
  void run_batches();
  void set_band(const Band& band) const;
  void resolve(const Band& band);

  std::unique_ptr<GlContext> context_;
  std::shared_ptr<GlMeshStore> store_;
  const GlFunctions& gl_;
  bool gains_by_batching_;
  Program program_;
  std::size_t room_ = 0;  // pixels per pass
  GLuint index_buffer_ = 0;
  GLuint differences_buffer_ = 0;
  std::size_t differences_size_ = 0;  // pixels; all are zero between passes

  // For the pass being prepared.
  std::vector<std::uint32_t> indices_;
  std::vector<Batch> batches_;
  std::vector<Band> bands_;
  std::size_t used_ = 0;                 // pixels
  std::span<std::int32_t> differences_;  // mapped
  std::vector<std::int64_t> sums_;       // of earlier passes, for the first band; or empty
};

}  // namespace trapeze
