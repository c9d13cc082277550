#include "server/documents/place_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>

#include "core/grid/web_mercator.h"

namespace trapeze {
namespace {

Point cell_of(LonLat place) {
  const auto to_cell = [](double position) {
    return static_cast<std::int32_t>(
        std::clamp<double>(std::floor(position), kGridMin, kGridMax - 1));
  };
  const GridPosition position = grid_from_lonlat(place);
  return {to_cell(position.x), to_cell(position.y)};
}

}  // namespace

std::optional<double> parse_number(std::string_view text, double min, double max) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!(number >= min && number <= max)) return std::nullopt;  // also rejects NaN
  return number;
}

std::optional<Point> parse_place(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const auto lon = parse_number(text.substr(0, comma), -180, 180);
  const auto lat = parse_number(text.substr(comma + 1), -kMaxLatitude, kMaxLatitude);
  if (!lon || !lat) return std::nullopt;
  return cell_of({*lon, *lat});
}

std::optional<Box> parse_box(std::string_view text) {
  const std::size_t middle = text.find(',', std::min(text.find(','), text.size() - 1) + 1);
  if (middle == std::string_view::npos) return std::nullopt;
  const auto south_west = parse_place(text.substr(0, middle));
  const auto north_east = parse_place(text.substr(middle + 1));
  if (!south_west || !north_east) return std::nullopt;
  const Box box = {south_west->x, north_east->y, north_east->x,
                   south_west->y};  // y grows southwards
  if (box.is_empty()) return std::nullopt;
  return box;
}

}  // namespace trapeze
