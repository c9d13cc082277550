// Makes the renderers of a command and tells the log what draws and what did not work.
#pragma once

#include <memory>
#include <vector>

#include "render/make_renderer.h"

namespace trapeze {

/// Throws std::runtime_error with all reasons if what is asked for does not work here.
std::vector<std::unique_ptr<CoverageRenderer>> start_renderers(const RendererOptions& options,
                                                               int count);

}  // namespace trapeze
