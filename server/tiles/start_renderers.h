// Makes the renderers of a command, and logs which draws and which did not work.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "render/make_renderer.h"

namespace trapeze {

/// Throws std::runtime_error with all reasons if what is asked for does not work here.
std::vector<std::unique_ptr<MaskRenderer>> start_renderers(const RendererOptions& options,
                                                           int count);

/// How many of them a configured number of workers takes: one a core if that is 0.
int renderer_count(unsigned workers);

/// Warms the renderers up, all at the same time: each draws a little of everything, so that the
/// first requests do not wait for what a GL device compiles at its first picture (60 to 100 ms on
/// llvmpipe, 4 ms where Mesa finds what it compiled before in its cache on disk). Throws
/// std::runtime_error if a device cannot draw.
void warm_up(std::span<const std::unique_ptr<MaskRenderer>> renderers);

}  // namespace trapeze
