// A file of polygons that is being written: in a folder of its own until it is complete.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <ogrsf_frmts.h>

#include "core/io/export/export_crs.h"
#include "core/io/file/unfinished.h"
#include "core/io/source/attribute_reader.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/gdal_messages.h"

namespace trapeze {

/// Belongs to one thread. An unfinished file is removed.
class PolygonFile {
 public:
  /// Begins the file; see export_layer() for formats, fields and errors. `source` must outlive it.
  PolygonFile(const std::string& path, const FeatureSource& source, ExportCrs crs);
  ~PolygonFile();
  PolygonFile(const PolygonFile&) = delete;
  PolygonFile& operator=(const PolygonFile&) = delete;

  /// Throws std::runtime_error if there is no such format, or no place for the file.
  static void check_path(const std::string& path, const std::string& source, bool overwrite);

  std::string driver() const;

  /// Writes `geometry` with the attributes of `feature`, which is of that layer of the source.
  void write(const OGRFeature& feature, std::size_t layer_index,
             std::unique_ptr<OGRGeometry> geometry);

  /// Completes the file, reads it again to verify that it is complete, and renames it.
  void finish();

 private:
  struct Format;
  struct Kind {
    OGRFieldType type = OFTString;
    OGRFieldSubType subtype = OFSTNone;
  };
  /// How a field of the source is written.
  struct OutField {
    int index = 0;           // in the file
    bool is_copied = false;  // the value of the source as it is, and not as AttributeReader has it
    std::vector<int> sources;  // by layer of the source, the field's index there, or -1
  };

  static const Format& format_of(const std::string& path);
  void create(ExportCrs crs);
  void create_layer(ExportCrs crs, const std::string& fid, const std::string& geometry);
  void create_fields(const std::string& id, const std::string& layer);
  void create_field(std::size_t field);
  Kind kind_of(std::size_t field, const std::vector<int>& sources) const;
  int add(const std::string& name, Kind kind);
  const OGRFieldDefn& source_field(std::size_t layer, int index) const;
  void set_attributes(const OGRFeature& from, std::size_t layer_index, OGRFeature& to);
  std::size_t count_written() const;
  [[noreturn]] void fail(const std::string& what) const;
  void require(bool is_done, const GdalMessages& messages) const;

  const std::string path_;
  const Format& format_;
  const FeatureSource& source_;
  const Unfinished folder_;  // of the unfinished file
  std::string unfinished_;
  GDALDatasetUniquePtr dataset_;
  OGRLayer* layer_ = nullptr;
  AttributeReader attributes_;
  std::vector<std::string> taken_names_;  // of columns, in lower case
  std::vector<OutField> fields_;
  int id_field_ = -1;
  int layer_field_ = -1;  // -1 if the source has one layer
  std::size_t written_ = 0;
};

}  // namespace trapeze
