// The files that layers are read from, and what can be seen of them without reading.
#pragma once

#include <string>
#include <vector>

#include "server/config/config.h"

namespace trapeze {

/// Appends the file that a source is, if it is one, and those that belong to it: the parts of a
/// Shapefile, the write-ahead log that a file of SQLite, such as a GeoPackage, may have; those of a
/// pattern, and their folder.
void append_files(const std::string& source, std::vector<std::string>& files);

/// What can be seen of files without reading them: equal as long as none was changed, replaced,
/// added or removed. An empty file is as one that is not there.
std::string state_of_files(const std::vector<std::string>& paths);

/// The same of all that the layer is read from: equal only if reading it again would give the same
/// layer. Empty if that cannot be told, as of a database or a folder.
std::string state_of_sources(const LayerConfig& layer);

}  // namespace trapeze
