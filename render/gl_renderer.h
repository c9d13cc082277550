// Draws coverage with OpenGL: exact area, not multisampling.
//
// The vertex shader pulls the integers of its trapezoid, makes them relative to the picture and
// cuts them to it in double precision, and emits a quad that touches every pixel the trapezoid
// does. The fragment shader integrates the area of pixel and trapezoid in closed form; additive
// blending sums the areas in 32-bit floats. (16 bits would not do: a city in a few pixels is tens
// of thousands of addends below their resolution.) The sum becomes 8 bits once, after read-back.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
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
  void draw(std::span<const MeshPart> parts, const View& view, Coverage& out) override;
  void forget(std::uint64_t mesh_id) override { store_->forget(mesh_id); }
  std::string_view name() const override;
  std::string description() const override { return context_->info().text(); }

  GlContext& context() { return *context_; }

 private:
  // A framebuffer of 32-bit floats.
  struct Target {
    int width = 0;
    int height = 0;
    GLuint framebuffer = 0;
    GLuint renderbuffer = 0;
  };

  void make_program();
  void make_quad_indices();
  void delete_objects() noexcept;
  void bind_target(int width, int height);
  void make_target(Target& target, int width, int height);
  void set_view(const View& view);
  void draw_part(const MeshPart& part);
  void draw_batch(const MeshView& mesh, std::uint32_t chunk);
  void read_back(Coverage& out);

  std::unique_ptr<GlContext> context_;
  std::shared_ptr<GlMeshStore> store_;
  const GlFunctions& gl_;
  GLint longest_side_ = 0;  // of a target, in pixels

  GLuint program_ = 0;
  GLint origin_location_ = -1;
  GLint pixels_per_cell_location_ = -1;
  GLint size_location_ = -1;
  GLuint vertex_array_ = 0;
  GLuint quad_indices_ = 0;
  std::array<Target, 4> targets_;  // of the sizes asked for last
  std::size_t next_target_ = 0;    // the one to give up for a new size

  // Runs of trapezoids to be drawn from one chunk by one call.
  std::vector<GLsizei> index_counts_;
  std::vector<GLint> base_vertices_;
  std::vector<const void*> index_offsets_;  // all null: every run begins at the first quad
  std::vector<float> sums_;
};

}  // namespace trapeze
