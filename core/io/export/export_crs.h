// The reference systems that polygons are written in.
#pragma once

#include <optional>
#include <string_view>

namespace trapeze {

enum class ExportCrs {
  degrees,      // EPSG:4326, longitude first
  web_mercator  // EPSG:3857, metres
};

/// By its EPSG name; none if it is another.
std::optional<ExportCrs> export_crs_from_name(std::string_view name);

}  // namespace trapeze
