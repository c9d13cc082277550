// Numbers, places and boxes in URLs: in degrees, separated by commas.
//
// Thread-safety: any thread.
#pragma once

#include <optional>
#include <string_view>

#include "core/grid/grid.h"

namespace trapeze {

/// The number, if the whole text is one from `min` to `max`. It may have a sign and an exponent.
std::optional<double> parse_number(std::string_view text, double min, double max);

/// Parses "longitude,latitude": the cell that contains the place; on the far edges of the world,
/// the last cell.
std::optional<Point> parse_place(std::string_view text);

/// Parses "west,south,east,north": the box from the cell of one corner to that of the other. West
/// must not be east of east, nor south north of north.
std::optional<Box> parse_box(std::string_view text);

}  // namespace trapeze
