// The device that all contestants draw with, and trapezoids on it that change from view to view.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/experiment/trapezoid_list.h"
#include "core/mesh/trapezoid_mesh.h"
#include "render/gl/gl_context.h"
#include "render/gl/gl_mesh_store.h"
#include "render/gl/gl_renderer.h"
#include "render/mask/mask.h"

namespace trapeze::experiment {

constexpr int kScreenWidth = 1600;   // pixels
constexpr int kScreenHeight = 1200;  // pixels

/// The trapezoids to draw of one layer.
using Ranges = std::vector<TrapezoidRange>;

/// One GlRenderer on the first EGL device that works. Used by one thread.
class Screen {
 public:
  /// `device` is as in RendererOptions. Throws std::runtime_error if there is no EGL device.
  explicit Screen(const std::string& device = {});

  MaskRenderer& renderer() { return *renderer_; }
  GlMeshStore& store() { return *store_; }
  GlContext& context() { return renderer_->context(); }

  /// Sends an immutable mesh, once.
  void send(const MeshView& mesh);
  void forget(std::uint64_t mesh_id);

  /// Draws layers in one pass, each into its own mask; meshes[i] is that of layer i.
  DrawTimes draw(std::span<const MeshView> meshes, std::span<const Ranges> ranges, const View& view,
                 std::vector<Mask>& masks);

 private:
  std::shared_ptr<GlMeshStore> store_;
  std::unique_ptr<GlRenderer> renderer_;
  std::vector<MeshPart> parts_;
  std::vector<MaskTask> tasks_;
};

/// Memory on the device for the trapezoids of a map that each view writes again. It is kept between
/// views, and written directly.
class DeviceTrapezoids {
 public:
  /// `screen` must outlive this object.
  explicit DeviceTrapezoids(Screen& screen) : screen_(screen), mesh_id_(new_mesh_id()) {}
  ~DeviceTrapezoids() { screen_.forget(mesh_id_); }
  DeviceTrapezoids(const DeviceTrapezoids&) = delete;
  DeviceTrapezoids& operator=(const DeviceTrapezoids&) = delete;

  /// Overwrites the previous trapezoids, and waits until the device has the new ones.
  void send(const TrapezoidList& trapezoids);

  /// The buffer of the chunk that begins with trapezoid `first`, to be filled on the device. A
  /// context of the screen must be current.
  GLuint buffer(std::size_t first);
  std::uint32_t chunk_size() const { return screen_.store().chunk_size(); }

  /// Draws layers: trapezoids ends[i - 1] .. ends[i] - 1 are those of layer i.
  DrawTimes draw(std::span<const std::uint32_t> ends, const View& view, std::vector<Mask>& masks);

 private:
  Screen& screen_;
  const std::uint64_t mesh_id_;
  std::vector<MeshView> meshes_;
  std::vector<Ranges> ranges_;
};

}  // namespace trapeze::experiment
