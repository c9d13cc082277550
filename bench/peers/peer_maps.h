// The maps of trips for other programs: the same polygons as indexed shapefiles, in the projection
// of the tiles so that nobody has to project while drawing, and the same colours.
#pragma once

#include <string>

#include "bench/measure/trip.h"

namespace trapeze {

/// Writes FOLDER/LAYER.shp for every layer, with the index of Mapnik and that of MapServer where
/// their programs are installed. Needs ogr2ogr. Throws std::runtime_error if that fails.
void write_shapes(const Trip& trip, const std::string& folder);

enum class Simplify { off, on };  // on: as the program itself can, to a quarter of a pixel

/// Writes a map over the shapes in the folder; its path.
std::string write_mapnik_map(const Trip& trip, const std::string& folder, Simplify simplify);
std::string write_mapserver_map(const Trip& trip, const std::string& folder, Simplify simplify);

/// Writes the tiles as mapnik_trip reads them; the path.
std::string write_tiles(const Trip& trip, const std::string& folder);

/// Whether a program is in PATH.
bool has_program(const std::string& name);

}  // namespace trapeze
