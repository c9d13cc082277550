// Colour ramps for maps, by name.
//
// The colours are those of ColorBrewer: this product includes color specifications and designs
// developed by Cynthia Brewer (http://colorbrewer.org/), under the Apache License 2.0.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/picture/colour.h"

namespace trapeze {

/// The canonical name of a ramp, ending with "-r" if it is reversed; nothing if there is no such
/// ramp. Ignores the case of `name`.
std::optional<std::string> find_ramp(std::string_view name);

/// The ramp's colours for `count` >= 1 classes; `name` comes from find_ramp(). Sequential and
/// diverging ramps are interpolated if more colours are needed than ColorBrewer has. Returns
/// nothing if the ramp is qualitative and has too few colours.
std::optional<std::vector<Rgba>> ramp_colours(std::string_view name, std::size_t count);

/// All names, separated by commas.
std::string ramp_names();

}  // namespace trapeze
