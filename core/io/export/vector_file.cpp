#include "core/io/export/vector_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <cpl_port.h>
#include <cpl_string.h>

#include "core/io/export/polygon_geometry.h"
#include "core/io/file/atomic_file.h"
#include "core/io/source/open_source.h"

namespace trapeze {

struct VectorFile::Format {
  const char* extension;
  const char* driver;
  bool has_one_geometry_type;
};

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_to_write(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": cannot be written: " + what);
}

void check_place_of_database(const std::string& path, std::string_view driver) {
  if (driver != "GPKG") return;
  const std::string problem = problem_with_database_at(path);
  if (!problem.empty()) fail_to_write(path, problem);
}

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

/// In the folder of the file, so that the file can be renamed to its place in one step.
Unfinished make_folder_beside(const std::string& path) {
  try {
    return Unfinished::folder_beside(path);
  } catch (const std::system_error& error) {
    fail_to_write(path, error.code().message());
  }
}

}  // namespace

const VectorFile::Format& VectorFile::format_of(const std::string& path) {
  static constexpr std::array<Format, 3> kFormats{
      {{".fgb", "FlatGeobuf", true}, {".gpkg", "GPKG", true}, {".geojson", "GeoJSON", false}}};
  const std::string extension = fs::path(path).extension().string();
  const auto* found = std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& format) {
    return EQUAL(format.extension, extension.c_str());  // ignoring case
  });
  if (found != kFormats.end()) return *found;
  fail_to_write(path,
                "its name must end in .fgb (FlatGeobuf), .gpkg (GeoPackage) or .geojson "
                "(GeoJSON)");
}

void VectorFile::check_path(const std::string& path, const std::string& source, bool overwrite) {
  const Format& format = format_of(path);
  std::error_code ignored;
  const fs::path folder = folder_of(path);
  if (!fs::is_directory(folder, ignored)) {
    fail_to_write(path, "there is no folder " + folder.string());
  }
  if (fs::equivalent(path, source, ignored)) fail_to_write(path, "it is the source itself");
  check_place_of_database(path, format.driver);
  const fs::file_type type = fs::symlink_status(path, ignored).type();
  if (type == fs::file_type::not_found) return;
  if (type != fs::file_type::regular) {
    fail_to_write(path, "something other than a regular file has this name");
  }
  if (!overwrite) fail_to_write(path, "it exists already; use --overwrite to replace it");
}

VectorFile::VectorFile(const std::string& path)
    : path_(path),
      format_(format_of(path)),
      folder_(make_folder_beside(path)),
      unfinished_((fs::path(folder_.path()) / fs::path(path).filename()).string()) {}

VectorFile::~VectorFile() {
  const GdalMessages unheard;  // of closing a discarded file
  dataset_.reset();
}

void VectorFile::create_layer(ExportCrs crs, const std::string& fid, const std::string& geometry) {
  const GdalMessages messages;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(format_.driver);
  if (driver == nullptr) fail(std::string("GDAL was built without ") + format_.driver);
  dataset_.reset(driver->Create(unfinished_.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  require(dataset_ != nullptr, messages);
  CPLStringList options;
  if (std::string_view(format_.driver) == "GPKG") {
    options.SetNameValue("FID", fid.c_str());
    options.SetNameValue("GEOMETRY_NAME", geometry.c_str());
  } else if (std::string_view(format_.driver) == "GeoJSON") {
    options.SetNameValue("COORDINATE_PRECISION", "15");  // the full precision of a double
    // Text such as "[1]" stays text; GDAL before 3.8 does not know this and writes an array.
    options.SetNameValue("AUTODETECT_JSON_STRINGS", "NO");
  }
  OGRSpatialReference reference = reference_of(crs);
  const std::string name = fs::path(path_).stem().string();
  layer_ = dataset_->CreateLayer(name.c_str(), &reference,
                                 format_.has_one_geometry_type ? wkbMultiPolygon : wkbUnknown,
                                 options.List());
  require(layer_ != nullptr, messages);
  // One transaction, if the format supports them: a million of them would take hours.
  if (dataset_->TestCapability(ODsCTransactions) != 0) {
    require(dataset_->StartTransaction() == OGRERR_NONE, messages);
  }
}

int VectorFile::add_field(const std::string& name, FieldKind kind) {
  const GdalMessages messages;
  OGRFieldDefn definition(name.c_str(), kind.type);
  definition.SetSubType(kind.subtype);
  require(layer_->CreateField(&definition) == OGRERR_NONE, messages);
  return layer_->GetLayerDefn()->GetFieldCount() - 1;
}

std::string VectorFile::driver_name() const {
  return format_.driver;
}

OGRFeatureUniquePtr VectorFile::new_feature() const {
  return OGRFeatureUniquePtr(OGRFeature::CreateFeature(layer_->GetLayerDefn()));
}

void VectorFile::write(OGRFeature& feature, std::unique_ptr<OGRGeometry> geometry) {
  const GdalMessages messages;
  if (format_.has_one_geometry_type) {
    geometry.reset(OGRGeometryFactory::forceToMultiPolygon(geometry.release()));
  }
  feature.SetGeometryDirectly(geometry.release());
  const bool is_created = layer_->CreateFeature(&feature) == OGRERR_NONE;
  require(is_created && !messages.has_failure(), messages);
  ++written_;
}

// Not every driver notices when its output does not arrive (GeoJSON's does not), so the file is
// read again.
void VectorFile::finish() {
  const GdalMessages messages;
  if (dataset_->TestCapability(ODsCTransactions) != 0) {
    require(dataset_->CommitTransaction() == OGRERR_NONE, messages);
  }
  dataset_.reset();
  require(!messages.has_failure(), messages);
  const std::size_t found = count_written();
  if (found != written_) {
    fail("only " + std::to_string(found) + " of " + std::to_string(written_) +
         " features arrived; is the disk full?");
  }
  check_place_of_database(path_, format_.driver);
  std::error_code error;
  Unfinished::give_name(unfinished_, path_, error);
  if (error) fail(error.message());
}

/// The number of features that can be read from the closed file.
std::size_t VectorFile::count_written() const {
  const ReadingSettings settings;
  const GdalMessages messages;
  const char* const drivers[] = {format_.driver, nullptr};
  const GDALDatasetUniquePtr dataset(GDALDataset::Open(
      unfinished_.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, drivers));
  if (dataset == nullptr || dataset->GetLayerCount() != 1) {
    fail("the written file cannot be read; is the disk full? (" + messages.text() + ")");
  }
  std::size_t count = 0;
  OGRLayer& layer = *dataset->GetLayer(0);
  while (OGRFeatureUniquePtr(layer.GetNextFeature()) != nullptr) ++count;
  require(!messages.has_failure(), messages);
  return count;
}

void VectorFile::fail(const std::string& what) const {
  fail_to_write(path_, what);
}

void VectorFile::require(bool is_done, const GdalMessages& messages) const {
  if (is_done) return;
  fail(messages.text().empty() ? "GDAL does not say why" : messages.text());
}

}  // namespace trapeze
