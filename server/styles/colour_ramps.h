// Ramps of colours for maps, by name.
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

/// The name as it is written in lists, with "-r" at its end if the ramp is to be reversed; nothing
/// if there is no such ramp. Letters of `name` may be of either case.
std::optional<std::string> find_ramp(std::string_view name);

/// The ramp's colours for `count` >= 1 classes; `name` is as find_ramp() gives it. Ramps that lead
/// from one end to another are interpolated where more are wanted than ColorBrewer has. Nothing if
/// the ramp is one of unlike colours and has not so many.
std::optional<std::vector<Rgba>> ramp_colours(std::string_view name, std::size_t count);

/// All names, with commas between.
std::string ramp_names();

}  // namespace trapeze
