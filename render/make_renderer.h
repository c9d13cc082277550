// Chooses the renderer: EGL, OSMesa or plain C++, the first one that works.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/name_table.h"
#include "render/mask/mask.h"

namespace trapeze {

enum class RendererKind { automatic, egl, osmesa, software };

inline constexpr NameTable<RendererKind, 4> kRendererNames({
    {"auto", RendererKind::automatic},
    {"egl", RendererKind::egl},
    {"osmesa", RendererKind::osmesa},
    {"software", RendererKind::software},
});

struct RendererOptions {
  RendererKind kind = RendererKind::automatic;
  /// The EGL device to prefer: its index, or a part of its name; empty for no preference.
  std::string device;
};

/// A renderer that was tried and does not work here, for a log.
struct RendererFailure {
  std::string what;
  std::string reason;
};

struct MadeRenderers {
  std::vector<std::unique_ptr<MaskRenderer>> renderers;
  std::vector<RendererFailure> failures;  // the renderers tried before, in order
};

/// Creates `count` renderers of the same kind, one for each drawing thread. GL renderers share
/// their meshes: each mesh is uploaded once, and one call of forget() frees it for all.
///
/// With `automatic`, tries EGL first, then OSMesa, and uses the software renderer if neither works.
/// With any other kind, throws std::runtime_error with all reasons if that kind does not work here.
MadeRenderers make_renderers(const RendererOptions& options, int count);

struct MadeRenderer {
  std::unique_ptr<MaskRenderer> renderer;
  std::vector<RendererFailure> failures;
};

/// The same for one thread.
MadeRenderer make_renderer(const RendererOptions& options = {});

}  // namespace trapeze
