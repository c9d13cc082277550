// The device that all contestants draw with, and trapezoids on it that change from view to view.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/experiment/trapezoid_record.h"
#include "core/trapezoid_mesh.h"
#include "render/coverage.h"
#include "render/gl_context.h"
#include "render/gl_mesh_store.h"
#include "render/gl_renderer.h"

namespace trapeze::experiment {

constexpr int kScreenWidth = 1600;   // pixels
constexpr int kScreenHeight = 1200;  // pixels

/// One GlRenderer on the EGL device that works first. Belongs to one thread.
class Screen {
 public:
  /// `device` as in RendererOptions. Throws std::runtime_error if there is no EGL device.
  explicit Screen(const std::string& device = {});

  CoverageRenderer& renderer() { return *renderer_; }
  GlMeshStore& store() { return *store_; }
  GlContext& context() { return renderer_->context(); }

  /// Sends a mesh that does not change, once for all.
  void send(const MeshView& mesh);
  void forget(const MeshView& mesh);

 private:
  std::shared_ptr<GlMeshStore> store_;
  std::unique_ptr<GlRenderer> renderer_;
};

/// Room on the device for trapezoids that each view writes anew. The room is kept between views,
/// and written to directly.
class DeviceTrapezoids {
 public:
  /// `screen` must outlive this.
  explicit DeviceTrapezoids(Screen& screen) : screen_(screen), mesh_id_(new_mesh_id()) {}
  ~DeviceTrapezoids() { screen_.renderer().forget(mesh_id_); }
  DeviceTrapezoids(const DeviceTrapezoids&) = delete;
  DeviceTrapezoids& operator=(const DeviceTrapezoids&) = delete;

  /// Writes the records over what was there, and waits until the device has them.
  void send(std::span<const TrapezoidRecord> records);

  /// For whoever fills the records on the device: makes room for `count`, and returns the buffer of
  /// a chunk of `chunk_size()` of them. A context of the screen is current.
  void reserve(std::size_t count);
  GLuint chunk_buffer(std::uint32_t chunk);
  std::uint32_t chunk_size() const { return screen_.store().chunk_size(); }

  /// Draws the first `count`.
  void draw(std::size_t count, const View& view, Coverage& out);

 private:
  MeshView mesh() const;

  Screen& screen_;
  const std::uint64_t mesh_id_;
  // Stand-ins for the store, which asks for a mesh when it makes a chunk.
  std::vector<Point> vertices_ = std::vector<Point>(1);
  std::vector<MeshEdge> edges_ = std::vector<MeshEdge>(1);
  std::vector<MeshTrapezoid> trapezoids_;
};

}  // namespace trapeze::experiment
