// Tile matrix sets from JSON, as the OGC writes them: version 2.0 of the standard, and what version
// 1.0 called otherwise.
//
// Thread-safety: any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/tiles/tile_matrix_set.h"

namespace trapeze {

/// The tile matrix set that JSON describes. Throws std::runtime_error that says what is wrong: a
/// part that is missing or is no such part, a scale that does not fit its cell size, a reference
/// system that PROJ does not know, rows of variable width.
TileMatrixSetPtr parse_tile_matrix_set(std::string_view json);

/// The same of a file, which the error names.
TileMatrixSetPtr read_tile_matrix_set(const std::string& path);

/// Those that are built in, and those of the files. Throws as read_tile_matrix_set() does, or if
/// two have the same id.
TileMatrixSets tile_matrix_sets_with(const std::vector<std::string>& files);

}  // namespace trapeze
