// Makes the renderers of a command and tells the log what draws and what did not work.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "render/make_renderer.h"

namespace trapeze {

/// Throws std::runtime_error with all reasons if what is asked for does not work here.
std::vector<std::unique_ptr<MaskRenderer>> start_renderers(const RendererOptions& options,
                                                           int count);

/// Has each draw a little of everything, all at once: what a GL device compiles at its first
/// picture is then ready, and the first visitors do not wait for it (60 to 100 ms on llvmpipe, 4 ms
/// where Mesa finds what it compiled before in its cache on disk).
/// Throws std::runtime_error if a device cannot draw.
void warm_up(std::span<const std::unique_ptr<MaskRenderer>> renderers);

}  // namespace trapeze
