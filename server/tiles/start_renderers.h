// Creates the renderers for a command, and logs which renderer draws and which did not work.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "render/make_renderer.h"

namespace trapeze {

/// Throws std::runtime_error with all reasons if the requested renderer does not work here.
std::vector<std::unique_ptr<MaskRenderer>> start_renderers(const RendererOptions& options,
                                                           int count);

/// The number of renderers for a configured number of workers: one per core if that is 0.
int renderer_count(unsigned workers);

/// Warms up the renderers, all at the same time. Each draws a little of everything, so that the
/// first requests do not wait for a GL device to compile its shaders (60 to 100 ms on llvmpipe, 4
/// ms if Mesa finds them in its disk cache). Throws std::runtime_error if a device cannot draw.
void warm_up(std::span<const std::unique_ptr<MaskRenderer>> renderers);

}  // namespace trapeze
