// A file of polygons, with the attributes of their source, while it is being written.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <ogrsf_frmts.h>

#include "core/io/export/export_crs.h"
#include "core/io/export/vector_file.h"
#include "core/io/source/attribute_reader.h"
#include "core/io/source/feature_source.h"

namespace trapeze {

/// For one thread. An unfinished file is removed.
class PolygonFile {
 public:
  /// Starts the file; see export_layer() for formats, fields and errors. `source` must outlive this
  /// object.
  PolygonFile(const std::string& path, const FeatureSource& source, ExportCrs crs);

  std::string driver() const { return file_.driver_name(); }

  /// Writes `geometry` with the attributes of `feature`, which belongs to that layer of the source.
  void write(const OGRFeature& feature, std::size_t layer_index,
             std::unique_ptr<OGRGeometry> geometry);

  void finish() { file_.finish(); }

 private:
  /// How a field of the source is written.
  struct OutField {
    int index = 0;             // in the file
    bool is_copied = false;    // the source's value is copied as is, instead of AttributeReader's
    std::vector<int> sources;  // by layer of the source, the field's index there, or -1
  };

  void create(ExportCrs crs);
  void create_fields(const std::string& id, const std::string& layer);
  void create_field(std::size_t field);
  FieldKind kind_of(std::size_t field, const std::vector<int>& sources) const;
  const OGRFieldDefn& source_field(std::size_t layer, int index) const;
  void set_attributes(const OGRFeature& from, std::size_t layer_index, OGRFeature& to);

  const FeatureSource& source_;
  VectorFile file_;
  AttributeReader attributes_;
  std::vector<std::string> taken_names_;  // of columns, in lower case
  std::vector<OutField> fields_;
  int id_field_ = -1;
  int layer_field_ = -1;  // -1 if the source has one layer
};

}  // namespace trapeze
