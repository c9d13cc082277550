#include "core/io/export/polygon_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include <cpl_string.h>

#include "core/io/export/polygon_geometry.h"
#include "core/io/source/open_source.h"

namespace trapeze {

struct PolygonFile::Format {
  const char* extension;
  const char* driver;
  bool has_one_geometry_type;
};

namespace {

namespace fs = std::filesystem;

std::string in_lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// The name itself or with a number, whichever no column has yet whatever the case, and takes it.
std::string take_free_name(const std::string& wanted, std::vector<std::string>& taken) {
  std::string name = wanted;
  const auto is_taken = [&] {
    return std::find(taken.begin(), taken.end(), in_lower_case(name)) != taken.end();
  };
  for (int number = 2; is_taken(); ++number) name = wanted + "_" + std::to_string(number);
  taken.push_back(in_lower_case(name));
  return name;
}

/// Whether a list such as "Integer Real String" in a driver's description has the word.
bool is_listed(GDALDriver& driver, const char* list, const char* word) {
  const char* words = driver.GetMetadataItem(list);
  return words != nullptr && CPLStringList(CSLTokenizeString(words)).FindString(word) >= 0;
}

bool can_hold(GDALDriver& driver, OGRFieldType type) {
  return is_listed(driver, GDAL_DMD_CREATIONFIELDDATATYPES, OGRFieldDefn::GetFieldTypeName(type));
}

bool can_hold(GDALDriver& driver, OGRFieldSubType subtype) {
  return subtype != OFSTNone && is_listed(driver, GDAL_DMD_CREATIONFIELDDATASUBTYPES,
                                          OGRFieldDefn::GetFieldSubTypeName(subtype));
}

OGRFieldType written_type(FieldType type) {
  if (type == FieldType::integer) return OFTInteger64;
  return type == FieldType::real ? OFTReal : OFTString;
}

/// What AttributeReader takes over as it is.
bool is_number_or_text(OGRFieldType type) {
  return type == OFTInteger || type == OFTInteger64 || type == OFTReal || type == OFTString;
}

void set_value(const Value& value, int index, OGRFeature& feature) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    feature.SetField(index, static_cast<GIntBig>(*integer));
  } else if (const auto* real = std::get_if<double>(&value)) {
    feature.SetField(index, *real);
  } else if (const auto* text = std::get_if<std::string_view>(&value)) {
    feature.SetField(index, std::string(*text).c_str());
  } else {
    feature.SetFieldNull(index);
  }
}

[[noreturn]] void fail_to_write(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": cannot be written: " + what);
}

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

/// In the folder of the file, so that the file can be moved to its place in one step.
Unfinished make_folder_beside(const std::string& path) {
  try {
    return Unfinished::folder_beside(path);
  } catch (const std::system_error& error) {
    fail_to_write(path, error.code().message());
  }
}

}  // namespace

const PolygonFile::Format& PolygonFile::format_of(const std::string& path) {
  static constexpr std::array<Format, 3> kFormats{
      {{".fgb", "FlatGeobuf", true}, {".gpkg", "GPKG", true}, {".geojson", "GeoJSON", false}}};
  const std::string extension = in_lower_case(fs::path(path).extension().string());
  const auto* found = std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& format) {
    return format.extension == extension;
  });
  if (found != kFormats.end()) return *found;
  fail_to_write(path,
                "its name must end in .fgb (FlatGeobuf), .gpkg (GeoPackage) or .geojson "
                "(GeoJSON)");
}

void PolygonFile::check_path(const std::string& path, const std::string& source, bool overwrite) {
  format_of(path);
  std::error_code ignored;
  const fs::path folder = folder_of(path);
  if (!fs::is_directory(folder, ignored)) {
    fail_to_write(path, "there is no folder " + folder.string());
  }
  if (fs::equivalent(path, source, ignored)) fail_to_write(path, "it is the source itself");
  const fs::file_type type = fs::symlink_status(path, ignored).type();
  if (type == fs::file_type::not_found) return;
  if (type != fs::file_type::regular) {
    fail_to_write(path, "something that is no plain file has that name");
  }
  if (!overwrite) fail_to_write(path, "it exists already; --overwrite replaces it");
}

PolygonFile::PolygonFile(const std::string& path, const FeatureSource& source, ExportCrs crs)
    : path_(path),
      format_(format_of(path)),
      source_(source),
      folder_(make_folder_beside(path)),
      unfinished_((fs::path(folder_.path()) / fs::path(path).filename()).string()) {
  try {
    create(crs);
  } catch (...) {
    dataset_.reset();
    throw;
  }
}

PolygonFile::~PolygonFile() {
  const GdalMessages unheard;  // of closing what is thrown away
  dataset_.reset();
}

std::string PolygonFile::driver() const {
  return format_.driver;
}

void PolygonFile::create(ExportCrs crs) {
  for (const SourceLayer& layer : source_.layers()) {
    attributes_.add_layer(*layer.layer->GetLayerDefn());
  }
  // The source's fields keep their names; the columns that are added here give way.
  std::vector<std::string> names;
  for (const Field& field : attributes_.fields()) names.push_back(in_lower_case(field.name));
  const auto add_name = [&](const char* wanted) {
    std::string name = take_free_name(wanted, names);
    taken_names_.push_back(in_lower_case(name));
    return name;
  };
  const std::string fid = add_name("fid");
  const std::string geometry = add_name("geom");
  create_layer(crs, fid, geometry);
  const std::string id = add_name("trapeze_id");
  create_fields(id, add_name("trapeze_layer"));
}

void PolygonFile::create_layer(ExportCrs crs, const std::string& fid, const std::string& geometry) {
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
    options.SetNameValue("COORDINATE_PRECISION", "15");  // all that a double has
  }
  OGRSpatialReference reference = reference_of(crs);
  const std::string name = fs::path(path_).stem().string();
  layer_ = dataset_->CreateLayer(name.c_str(), &reference,
                                 format_.has_one_geometry_type ? wkbMultiPolygon : wkbUnknown,
                                 options.List());
  require(layer_ != nullptr, messages);
  // One transaction, where there are such: a million of them would take hours.
  if (dataset_->TestCapability(ODsCTransactions) != 0) {
    require(dataset_->StartTransaction() == OGRERR_NONE, messages);
  }
}

void PolygonFile::create_fields(const std::string& id, const std::string& layer) {
  id_field_ = add(id, {OFTInteger64});
  if (source_.layers().size() > 1) layer_field_ = add(layer, {OFTString});
  for (std::size_t i = 0; i < attributes_.fields().size(); ++i) create_field(i);
}

void PolygonFile::create_field(std::size_t field) {
  OutField out;
  for (std::size_t layer = 0; layer < source_.layers().size(); ++layer) {
    const std::vector<std::size_t>& numbers = attributes_.fields_of(layer);
    const auto found = std::find(numbers.begin(), numbers.end(), field);
    out.sources.push_back(found == numbers.end() ? -1 : static_cast<int>(found - numbers.begin()));
  }
  const Kind kind = kind_of(field, out.sources);
  out.is_copied = !is_number_or_text(kind.type);
  const std::string wanted = attributes_.fields()[field].name;
  out.index = add(take_free_name(wanted.empty() ? "field" : wanted, taken_names_), kind);
  fields_.push_back(std::move(out));
}

/// The type of the field in all layers, if it is one and the format has it.
PolygonFile::Kind PolygonFile::kind_of(std::size_t field, const std::vector<int>& sources) const {
  std::vector<const OGRFieldDefn*> originals;
  for (std::size_t layer = 0; layer < sources.size(); ++layer) {
    if (sources[layer] >= 0) originals.push_back(&source_field(layer, sources[layer]));
  }
  const Kind first{originals.front()->GetType(), originals.front()->GetSubType()};
  const bool are_alike = std::all_of(originals.begin(), originals.end(), [&](const auto* other) {
    return other->GetType() == first.type && other->GetSubType() == first.subtype;
  });
  GDALDriver& driver = *dataset_->GetDriver();
  if (!are_alike || !can_hold(driver, first.type)) {
    return {written_type(attributes_.fields()[field].type)};
  }
  return {first.type, can_hold(driver, first.subtype) ? first.subtype : OFSTNone};
}

const OGRFieldDefn& PolygonFile::source_field(std::size_t layer, int index) const {
  return *source_.layers()[layer].layer->GetLayerDefn()->GetFieldDefn(index);
}

/// The index of the new field in the file.
int PolygonFile::add(const std::string& name, Kind kind) {
  const GdalMessages messages;
  OGRFieldDefn definition(name.c_str(), kind.type);
  definition.SetSubType(kind.subtype);
  require(layer_->CreateField(&definition) == OGRERR_NONE, messages);
  return layer_->GetLayerDefn()->GetFieldCount() - 1;
}

void PolygonFile::write(const OGRFeature& feature, std::size_t layer_index,
                        std::unique_ptr<OGRGeometry> geometry) {
  const GdalMessages messages;
  const OGRFeatureUniquePtr out(OGRFeature::CreateFeature(layer_->GetLayerDefn()));
  out->SetField(id_field_, static_cast<GIntBig>(feature.GetFID()));
  if (layer_field_ >= 0) {
    out->SetField(layer_field_, source_.layers()[layer_index].layer->GetName());
  }
  set_attributes(feature, layer_index, *out);
  if (format_.has_one_geometry_type) {
    geometry.reset(OGRGeometryFactory::forceToMultiPolygon(geometry.release()));
  }
  out->SetGeometryDirectly(geometry.release());
  const bool is_created = layer_->CreateFeature(out.get()) == OGRERR_NONE;
  require(is_created && !messages.has_failure(), messages);
  ++written_;
}

void PolygonFile::set_attributes(const OGRFeature& from, std::size_t layer_index, OGRFeature& to) {
  const std::vector<Value>& values = attributes_.read(from, layer_index);
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const OutField& field = fields_[i];
    const int source = field.sources[layer_index];
    if (field.is_copied && source >= 0 && from.IsFieldSetAndNotNull(source)) {
      to.SetField(field.index, from.GetRawFieldRef(source));
    } else {
      set_value(field.is_copied ? Value() : values[i], field.index, to);
    }
  }
}

// Not every driver notices that what it writes does not arrive (GeoJSON's does not), so the file is
// read again.
void PolygonFile::finish() {
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
  std::error_code error;
  Unfinished::give_name(unfinished_, path_, error);
  if (error) fail(error.message());
}

/// Features that can be read in the closed file.
std::size_t PolygonFile::count_written() const {
  const ReadingSettings settings;
  const GdalMessages messages;
  const char* const drivers[] = {format_.driver, nullptr};
  const GDALDatasetUniquePtr dataset(GDALDataset::Open(
      unfinished_.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, drivers));
  if (dataset == nullptr || dataset->GetLayerCount() != 1) {
    fail("what was written cannot be read again; is the disk full? (" + messages.text() + ")");
  }
  std::size_t count = 0;
  OGRLayer& layer = *dataset->GetLayer(0);
  while (OGRFeatureUniquePtr(layer.GetNextFeature()) != nullptr) ++count;
  require(!messages.has_failure(), messages);
  return count;
}

void PolygonFile::fail(const std::string& what) const {
  fail_to_write(path_, what);
}

void PolygonFile::require(bool is_done, const GdalMessages& messages) const {
  if (is_done) return;
  fail(messages.text().empty() ? "GDAL does not say why" : messages.text());
}

}  // namespace trapeze
