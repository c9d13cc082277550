// Numbers, places and boxes in URLs: in degrees, separated by commas.
//
// Thread-safety: any thread.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "core/grid/grid.h"

namespace trapeze {

/// The number, if the whole text is one from `min` to `max`. It may have a sign and an exponent.
std::optional<double> parse_number(std::string_view text, double min, double max);

/// Parses four numbers from -`most` to `most`, separated by commas.
std::optional<std::array<double, 4>> parse_four_numbers(std::string_view text, double most);

/// Parses "longitude,latitude": the cell that contains the place; on the far edges of the world,
/// the last cell.
std::optional<Point> parse_place(std::string_view text);

/// Parses "west,south,east,north": the box from the cell of one corner to that of the other. South
/// must not be north of north. Longitudes may be several worlds away, as in map windows; if west is
/// east of east, the box crosses the antimeridian (RFC 7946, 5.2) and becomes two. Parts beyond the
/// map in the north and south are cut off. Empty if the text is not a box.
std::vector<Box> parse_boxes(std::string_view text);

}  // namespace trapeze
