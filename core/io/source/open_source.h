// Opens vector sources for reading, only with drivers of an allow list.
//
// Thread-safety: may be called from any thread. A dataset is used by one thread at a time.
#pragma once

#include <stdexcept>
#include <string>

#include <gdal_priv.h>

namespace trapeze {

/// A problem with a source as a whole. The message does not contain its name.
class SourceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Opens `path` (a file, a File Geodatabase folder, a GDAL /vsi path or a PostgreSQL connection
/// string) read-only. Throws std::runtime_error that names the source and the problem: missing, a
/// folder, unreadable, empty, no vector data, a format that is not allowed, or broken. `warning`,
/// if not null, receives GDAL's first error or, if there is none, its first warning.
GDALDatasetUniquePtr open_source(const std::string& path, std::string* warning = nullptr);

/// Whether sources of this driver hold plain rings, which GDAL would have to group to polygons, and
/// whose outer rings are clockwise by definition of the format.
bool has_clockwise_shells(const std::string& driver);

/// While an object exists, GDAL drivers on this thread return rings as stored instead of
/// determining their nesting (which is quadratic in the number of rings, and pointless with
/// even-odd), accept GeoJSON features of any size, and place temporary files for them in the
/// system's temporary folder.
class ReadingSettings {
 public:
  ReadingSettings();
  ~ReadingSettings();
  ReadingSettings(const ReadingSettings&) = delete;
  ReadingSettings& operator=(const ReadingSettings&) = delete;
};

}  // namespace trapeze
