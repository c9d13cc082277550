#include "server/documents/place_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>

#include "core/grid/web_mercator.h"
#include "server/tiles/map_window.h"

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

Box box_between(double west, double south, double east, double north) {
  const auto on_map = [](double lat) { return std::clamp(lat, -kMaxLatitude, kMaxLatitude); };
  const Point south_west = cell_of({west, on_map(south)});
  const Point north_east = cell_of({east, on_map(north)});
  return {south_west.x, north_east.y, north_east.x, south_west.y};  // y grows southwards
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

std::optional<std::array<double, 4>> parse_four_numbers(std::string_view text, double most) {
  std::array<double, 4> numbers{};
  for (double& number : numbers) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const auto parsed = parse_number(text.substr(0, comma), -most, most);
    const bool is_last = &number == &numbers.back();
    if (!parsed || (comma == text.size()) != is_last) return std::nullopt;
    number = *parsed;
    text.remove_prefix(is_last ? comma : comma + 1);
  }
  return numbers;
}

std::optional<Point> parse_place(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const auto lon = parse_number(text.substr(0, comma), -180, 180);
  const auto lat = parse_number(text.substr(comma + 1), -kMaxLatitude, kMaxLatitude);
  if (!lon || !lat) return std::nullopt;
  return cell_of({*lon, *lat});
}

std::vector<Box> parse_boxes(std::string_view text) {
  const auto numbers = parse_four_numbers(text, 360.0 * kMostWorlds);
  if (!numbers) return {};
  auto [west, south, east, north] = *numbers;
  if (west > east) east += 360;
  if (west > east || south > north || south < -90 || north > 90) return {};
  const double turn = west > 180 || west < -180 ? -360 * std::floor((west + 180) / 360) : 0;
  west += turn;
  east += turn;
  if (east - west >= 360) return {box_between(-180, south, 180, north)};
  if (east <= 180) return {box_between(west, south, east, north)};
  return {box_between(west, south, 180, north), box_between(-180, south, east - 360, north)};
}

}  // namespace trapeze
