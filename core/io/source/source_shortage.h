// Finds files that lack a part of what they say they hold, where GDAL does not: it takes a record
// that lies beyond the end of its file for one bad feature, and a table that cannot be opened for
// none at all.
//
// Thread-safety: any thread; the dataset is used by one thread at a time.
#pragma once

#include <string>

#include <gdal_priv.h>

namespace trapeze {

/// In words, what the files of a dataset lack: of a Shapefile, shapes or rows, by the numbers in
/// its .shx and .dbf; of an SQLite database, such as a GeoPackage, the end of its last page. Empty
/// if nothing is known to be lacking. Reads headers and the .shx only.
std::string shortage_of_files(GDALDataset& dataset);

/// Whether sources of this driver say how many features a layer has, as many as can be read of it.
bool tells_feature_count(const std::string& driver);

/// How many features of a layer can be read, whatever condition was set: which is gone afterwards,
/// as are its ignored fields, and reading begins anew.
GIntBig count_readable(OGRLayer& layer);

}  // namespace trapeze
