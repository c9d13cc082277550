// Sources that nobody should have to load: polygons that a faulty program, a broken file or an
// attacker could produce.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tests/hostile/hostile_shapes.h"

namespace trapeze {

struct HostileFeature {
  std::vector<LonLatPolygon> parts = {};
  std::string wkt = {};  // instead of parts, for all but polygons of straight edges
  std::string text = {};
};

struct HostileInput {
  const char* name;  // letters and digits
  std::vector<HostileFeature> (*make)();
  const char* crs = "EPSG:4326";
};

std::span<const HostileInput> hostile_inputs();

}  // namespace trapeze
