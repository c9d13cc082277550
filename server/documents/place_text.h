// Numbers, places and boxes as they stand in addresses: in degrees, with commas between.
//
// Thread-safety: any thread.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "core/grid/grid.h"

namespace trapeze {

/// The number that all of the text is, if it is one from `min` to `max`. A sign and an exponent may
/// be written.
std::optional<double> parse_number(std::string_view text, double min, double max);

/// Four numbers from -`most` to `most`, with commas between.
std::optional<std::array<double, 4>> parse_four_numbers(std::string_view text, double most);

/// "longitude,latitude": the cell that holds the place; of those on the edge of the world the last.
std::optional<Point> parse_place(std::string_view text);

/// "west,south,east,north": from the cell of one corner to that of the other, south not north of
/// north. Longitudes may be several worlds away, as in windows of the map, and where the west is
/// east of the east, the box goes over the antimeridian (RFC 7946, 5.2): then it is two. What lies
/// beyond the map in the north and south is left out. Nothing if the text is no box.
std::vector<Box> parse_boxes(std::string_view text);

}  // namespace trapeze
