// Opens vector sources for reading, with drivers of an allowed list only.
//
// Thread-safety: any thread; a dataset is used by one thread at a time.
#pragma once

#include <stdexcept>
#include <string>

#include <gdal_priv.h>

namespace trapeze {

/// Something is wrong with a source as a whole. The message does not contain its name.
class SourceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Opens `path` (a file, a File Geodatabase folder, a GDAL /vsi path or a PostgreSQL connection
/// string) read-only. Throws std::runtime_error that names the source and says what is wrong: not
/// there, a folder, unreadable, empty, no vector data, a format that is not allowed, or broken.
GDALDatasetUniquePtr open_source(const std::string& path);

/// Whether sources of this driver hold plain rings whose grouping to polygons GDAL would have to
/// find out, and whose outer rings run clockwise by definition of the format.
bool has_clockwise_shells(const std::string& driver);

/// While it lives, GDAL drivers on this thread return rings as they are stored instead of working
/// out which ring lies in which (quadratic in the rings; even-odd makes it pointless), take GeoJSON
/// features of any size, and put temporary files into the system's folder for them.
class ReadingSettings {
 public:
  ReadingSettings();
  ~ReadingSettings();
  ReadingSettings(const ReadingSettings&) = delete;
  ReadingSettings& operator=(const ReadingSettings&) = delete;
};

}  // namespace trapeze
