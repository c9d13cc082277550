// Reads tile matrix sets from JSON as defined by the OGC: version 2.0 of the standard, and the
// names that version 1.0 used.
//
// Thread-safety: any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/tiles/tile_matrix_set.h"

namespace trapeze {

/// Parses a tile matrix set from JSON. Throws std::runtime_error that says what is wrong: a member
/// that is missing or has the wrong type, a scale that does not match the cell size, a reference
/// system that PROJ does not know, or rows of variable width.
TileMatrixSetPtr parse_tile_matrix_set(std::string_view json);

/// Reads one from a file, which the error names.
TileMatrixSetPtr read_tile_matrix_set(const std::string& path);

/// The built-in sets and those from the files. Throws as read_tile_matrix_set() does, and if two
/// sets have the same id.
TileMatrixSets tile_matrix_sets_with(const std::vector<std::string>& files);

}  // namespace trapeze
