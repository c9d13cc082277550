// Draws coverage with OpenGL: exact area, not multisampling. See gl_shaders.h for how.
//
// Additive blending sums the differences of areas in 32-bit floats. (16 bits would not do: a city
// in a few pixels is tens of thousands of addends below their resolution.) Sums become 8 bits once,
// after read-back.
//
// Tasks that are drawn together share one target, one above the other: the fixed cost of a pass,
// which is what a light tile costs, is paid once for all.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "render/coverage.h"
#include "render/gl_context.h"
#include "render/gl_mesh_store.h"

namespace trapeze {

/// The context is current only inside of draw, so the renderer may move between threads.
class GlRenderer final : public CoverageRenderer {
 public:
  /// `store` is that of the context's share group. Throws std::runtime_error if the device cannot
  /// do what is needed.
  GlRenderer(std::unique_ptr<GlContext> context, std::shared_ptr<GlMeshStore> store);
  ~GlRenderer() override;
  GlRenderer(const GlRenderer&) = delete;
  GlRenderer& operator=(const GlRenderer&) = delete;

  using CoverageRenderer::draw;
  DrawTimes draw(std::span<const CoverageTask> tasks) override;
  bool gains_by_company() const override { return true; }
  void forget(std::uint64_t mesh_id) override { store_->forget(mesh_id); }
  std::string_view name() const override;
  std::string description() const override { return context_->info().text(); }

  GlContext& context() { return *context_; }

 private:
  struct Program {
    GLuint name = 0;
    GLint origin = -1;
    GLint pixels_per_cell = -1;
    GLint size = -1;
    GLint first_row = -1;
  };

  // A framebuffer of 32-bit floats.
  struct Target {
    int width = 0;
    int height = 0;
    GLuint framebuffer = 0;
    GLuint renderbuffer = 0;
  };

  // Some of indices_, drawn by one call. All indices of points come before those of sides.
  struct Batch {
    std::size_t task = 0;  // in the pass
    GlMeshStore::ChunkPointer chunk;
    std::size_t first = 0;
    std::size_t count = 0;
  };

  Program make_program(const std::string& vertex_source, const std::string& fragment_source);
  void make_vertex_array();
  void delete_objects() noexcept;
  void draw_pass(std::span<const CoverageTask> tasks, DrawTimes& times);
  void bind_target(int width, int height);
  void make_target(Target& target, int width, int height);
  void collect(std::span<const CoverageTask> tasks);
  void collect_run(const GlMeshStore::Chunk& chunk, std::uint32_t first, std::uint32_t count,
                   std::uint8_t largest_point);
  void end_batches(std::size_t task, const GlMeshStore::ChunkPointer& chunk);
  void upload_indices();
  void draw_batches(std::span<const CoverageTask> tasks, const Program& program,
                    const std::vector<Batch>& batches, GLenum mode, std::size_t first_index);
  void set_task(const Program& program, const View& view, std::size_t task);
  void read_back(std::span<const CoverageTask> tasks);
  void resolve(std::span<const CoverageTask> tasks) const;

  std::unique_ptr<GlContext> context_;
  std::shared_ptr<GlMeshStore> store_;
  const GlFunctions& gl_;
  GLint longest_side_ = 0;        // of a target, in pixels
  bool can_draw_points_ = false;  // as large as they come here

  Program point_program_;
  Program side_program_;
  GLuint vertex_array_ = 0;
  GLuint index_buffer_ = 0;
  std::array<Target, 8> targets_;  // of the sizes asked for last
  std::size_t next_target_ = 0;    // the one to give up for a new size

  // Of the pass being drawn.
  std::vector<std::uint32_t> point_indices_;
  std::vector<std::uint32_t> side_indices_;
  std::vector<Batch> point_batches_;
  std::vector<Batch> side_batches_;
  std::vector<float> differences_;
};

}  // namespace trapeze
