// Detects files that lack a part of their declared content where GDAL does not: GDAL treats a
// record beyond the end of its file as one bad feature, and ignores a table that cannot be opened.
//
// Thread-safety: may be called from any thread; the dataset is used by one thread at a time.
#pragma once

#include <string>

#include <gdal_priv.h>

namespace trapeze {

/// What the files of a dataset lack, in words: for a Shapefile, shapes or rows, according to its
/// .shx and .dbf; for an SQLite database, such as a GeoPackage, the end of its last page; for a
/// GeoJSON of one feature, what follows it. Empty if nothing is known to be missing. Reads only
/// headers, the .shx and a GeoJSON of one feature.
std::string shortage_of_files(GDALDataset& dataset);

/// Whether the feature count that sources of this driver declare for a layer equals the number that
/// can be read.
bool tells_feature_count(const std::string& driver);

/// How many features of a layer can be read without any condition. Removes the condition and the
/// ignored fields that were set, and restarts reading.
GIntBig count_readable(OGRLayer& layer);

}  // namespace trapeze
