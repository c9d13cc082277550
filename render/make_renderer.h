// Chooses how to draw: by EGL, by OSMesa, or in plain C++, whatever works first.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/mask/mask.h"

namespace trapeze {

enum class RendererKind { automatic, egl, osmesa, software };

/// "auto", "egl", "osmesa" or "software"; nothing for other words.
std::optional<RendererKind> renderer_kind_from(std::string_view word);

struct RendererOptions {
  RendererKind kind = RendererKind::automatic;
  /// The EGL device to prefer: its index, or a part of its name; empty for no preference.
  std::string device;
};

/// A way of drawing that was tried and does not work here, in words for a log.
struct RendererFailure {
  std::string what;
  std::string reason;
};

struct MadeRenderers {
  std::vector<std::unique_ptr<MaskRenderer>> renderers;
  std::vector<RendererFailure> failures;  // what was tried before
};

/// Makes `count` renderers of one sort, one for each thread that draws. Those that draw by GL keep
/// their meshes together: each mesh is uploaded once, and one call of forget is enough for all.
///
/// With `automatic`, EGL is tried first, then OSMesa, and the software renderer is what is left if
/// nothing else works. With any other kind, throws std::runtime_error with all reasons if that kind
/// does not work here.
MadeRenderers make_renderers(const RendererOptions& options, int count);

struct MadeRenderer {
  std::unique_ptr<MaskRenderer> renderer;
  std::vector<RendererFailure> failures;
};

/// The same for one thread.
MadeRenderer make_renderer(const RendererOptions& options = {});

}  // namespace trapeze
