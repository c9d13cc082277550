// Numbers, places and boxes as they stand in addresses: in degrees, with commas between.
//
// Thread-safety: any thread.
#pragma once

#include <optional>
#include <string_view>

#include "core/grid/grid.h"

namespace trapeze {

/// The number that all of the text is, if it is one from `min` to `max`. A sign and an exponent may
/// be written.
std::optional<double> parse_number(std::string_view text, double min, double max);

/// "longitude,latitude": the cell that holds the place; of those on the edge of the world the last.
std::optional<Point> parse_place(std::string_view text);

/// "west,south,east,north": from the cell of one corner to that of the other, neither west of east
/// nor south of north.
std::optional<Box> parse_box(std::string_view text);

}  // namespace trapeze
