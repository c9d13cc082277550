// The maps of trips for other programs: the same polygons as indexed Shapefiles, in the projection
// of the tiles so that no program has to project while drawing, and the same colours.
#pragma once

#include <string>

#include "bench/measure/trip.h"

namespace trapeze {

/// Writes FOLDER/LAYER.shp for every layer, with the indexes of Mapnik and MapServer if their
/// programs are installed. Needs ogr2ogr. Throws std::runtime_error if that fails.
void write_shapes(const Trip& trip, const std::string& folder);

enum class Simplify { off, on };  // on: as the program itself supports it, to a quarter of a pixel

/// Writes a map of the Shapefiles in the folder; returns its path.
std::string write_mapnik_map(const Trip& trip, const std::string& folder, Simplify simplify);
std::string write_mapserver_map(const Trip& trip, const std::string& folder, Simplify simplify);

/// Writes the tiles in the format of mapnik_trip; returns the path.
std::string write_tiles(const Trip& trip, const std::string& folder);

/// Whether a program is in PATH.
bool has_program(const std::string& name);

}  // namespace trapeze
