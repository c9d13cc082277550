// The files that layers are read from, and what can be determined about them without reading them.
#pragma once

#include <string>
#include <vector>

#include "server/config/config.h"

namespace trapeze {

/// Appends the file of a source, if it is a file, and the files that belong to it: the parts of a
/// Shapefile, the write-ahead log of an SQLite file such as a GeoPackage; for a pattern, the
/// matching files and their folder.
void append_files(const std::string& source, std::vector<std::string>& files);

/// The state of files without reading their contents: equal as long as none is changed, replaced,
/// added or removed. An empty file counts as missing.
std::string state_of_files(const std::vector<std::string>& paths);

/// The same for everything that the layer is read from: equal only if reading it again would give
/// the same layer. Empty if that cannot be determined, for example for a database or a folder.
std::string state_of_sources(const LayerConfig& layer);

}  // namespace trapeze
