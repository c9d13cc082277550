// A file of polygons in one of GDAL's formats while it is being written: in a temporary folder
// until it is complete.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include <ogrsf_frmts.h>

#include "core/io/export/export_crs.h"
#include "core/io/file/unfinished.h"
#include "core/io/source/gdal_messages.h"

namespace trapeze {

struct FieldKind {
  OGRFieldType type = OFTString;
  OGRFieldSubType subtype = OFSTNone;
};

/// FlatGeobuf (.fgb), GeoPackage (.gpkg) or GeoJSON (.geojson) with one layer, named after the
/// file. All members throw std::runtime_error that names the path. For one thread. An unfinished
/// file is removed.
class VectorFile {
 public:
  /// Starts the file. `path` has passed check_path().
  explicit VectorFile(const std::string& path);
  ~VectorFile();
  VectorFile(const VectorFile&) = delete;
  VectorFile& operator=(const VectorFile&) = delete;

  /// Throws std::runtime_error if the format is not supported, or if the file cannot be placed
  /// there.
  static void check_path(const std::string& path, const std::string& source, bool overwrite);

  /// Must be called once, before the other members. `fid` and `geometry` name the respective
  /// columns in formats that have them.
  void create_layer(ExportCrs crs, const std::string& fid, const std::string& geometry);
  /// The index of the new field.
  int add_field(const std::string& name, FieldKind kind);

  std::string driver_name() const;
  /// Valid until the file is finished.
  GDALDriver& driver() const { return *dataset_->GetDriver(); }
  OGRFeatureUniquePtr new_feature() const;
  /// In formats whose layers have one type of geometry, all features are multipolygons.
  void write(OGRFeature& feature, std::unique_ptr<OGRGeometry> geometry);

  /// Completes the file, reads it again to verify that it is complete, and renames it.
  void finish();

 private:
  struct Format;

  static const Format& format_of(const std::string& path);
  std::size_t count_written() const;
  [[noreturn]] void fail(const std::string& what) const;
  void require(bool is_done, const GdalMessages& messages) const;

  const std::string path_;
  const Format& format_;
  const Unfinished folder_;  // of the unfinished file
  const std::string unfinished_;
  GDALDatasetUniquePtr dataset_;
  OGRLayer* layer_ = nullptr;
  std::size_t written_ = 0;
};

}  // namespace trapeze
