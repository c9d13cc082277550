// Makes the overview of a layer in several prepared parts.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/io/prepared/prepared_parts.h"

namespace trapeze {

/// The last zoom at which a tile within the area of these boxes intersects more than a few of them;
/// 0 if there is none.
int last_zoom_of_overview(std::span<const Box> boxes);

/// An overview for tiles up to that zoom at scale 1; one part is loaded at a time. Throws
/// std::runtime_error that names the part if one is damaged, and std::length_error if there are
/// more items of any kind than 32 bits can count. `progress` receives the fraction of the parts
/// that are done.
LoadedLayer overview_of(const std::vector<std::shared_ptr<const PreparedPart>>& parts,
                        const std::function<void(double)>& progress = {});

}  // namespace trapeze
