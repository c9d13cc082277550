// The reference systems in which polygons are written.
#pragma once

#include "core/grid/name_table.h"

namespace trapeze {

enum class ExportCrs {
  degrees,      // EPSG:4326, longitude first
  web_mercator  // EPSG:3857, metres
};

inline constexpr NameTable<ExportCrs, 2> kExportCrsNames({
    {"EPSG:4326", ExportCrs::degrees},
    {"EPSG:3857", ExportCrs::web_mercator},
});

}  // namespace trapeze
