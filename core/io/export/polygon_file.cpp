#include "core/io/export/polygon_file.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>
#include <variant>

#include <cpl_string.h>

namespace trapeze {
namespace {

std::string in_lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Reserves a name: the wanted one, or that with a number, whichever no column has yet, ignoring
/// case.
std::string take_free_name(const std::string& wanted, std::vector<std::string>& taken) {
  std::string name = wanted;
  const auto is_taken = [&] {
    return std::find(taken.begin(), taken.end(), in_lower_case(name)) != taken.end();
  };
  for (int number = 2; is_taken(); ++number) name = wanted + "_" + std::to_string(number);
  taken.push_back(in_lower_case(name));
  return name;
}

/// Whether a list in a driver's description, such as "Integer Real String", contains the word.
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

/// Whether AttributeReader keeps values of the type as they are.
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

}  // namespace

PolygonFile::PolygonFile(const std::string& path, const FeatureSource& source, ExportCrs crs)
    : source_(source), file_(path) {
  create(crs);
}

void PolygonFile::create(ExportCrs crs) {
  for (const SourceLayer& layer : source_.layers()) {
    attributes_.add_layer(*layer.layer->GetLayerDefn());
  }
  // The source's fields keep their names; the columns added here are renamed if necessary.
  std::vector<std::string> names;
  for (const Field& field : attributes_.fields()) names.push_back(in_lower_case(field.name));
  const auto add_name = [&](const char* wanted) {
    std::string name = take_free_name(wanted, names);
    taken_names_.push_back(in_lower_case(name));
    return name;
  };
  const std::string fid = add_name("fid");
  const std::string geometry = add_name("geom");
  file_.create_layer(crs, fid, geometry);
  const std::string id = add_name("trapeze_id");
  create_fields(id, add_name("trapeze_layer"));
}

void PolygonFile::create_fields(const std::string& id, const std::string& layer) {
  id_field_ = file_.add_field(id, {OFTInteger64});
  if (source_.layers().size() > 1) layer_field_ = file_.add_field(layer, {OFTString});
  for (std::size_t i = 0; i < attributes_.fields().size(); ++i) create_field(i);
}

void PolygonFile::create_field(std::size_t field) {
  OutField out;
  for (std::size_t layer = 0; layer < source_.layers().size(); ++layer) {
    const std::vector<std::size_t>& numbers = attributes_.fields_of(layer);
    const auto found = std::find(numbers.begin(), numbers.end(), field);
    out.sources.push_back(found == numbers.end() ? -1 : static_cast<int>(found - numbers.begin()));
  }
  const FieldKind kind = kind_of(field, out.sources);
  out.is_copied = !is_number_or_text(kind.type);
  const std::string wanted = attributes_.fields()[field].name;
  out.index =
      file_.add_field(take_free_name(wanted.empty() ? "field" : wanted, taken_names_), kind);
  fields_.push_back(std::move(out));
}

/// The type of the field in all layers, if it is the same and the format supports it.
FieldKind PolygonFile::kind_of(std::size_t field, const std::vector<int>& sources) const {
  std::vector<const OGRFieldDefn*> originals;
  for (std::size_t layer = 0; layer < sources.size(); ++layer) {
    if (sources[layer] >= 0) originals.push_back(&source_field(layer, sources[layer]));
  }
  const FieldKind first{originals.front()->GetType(), originals.front()->GetSubType()};
  const bool are_alike = std::all_of(originals.begin(), originals.end(), [&](const auto* other) {
    return other->GetType() == first.type && other->GetSubType() == first.subtype;
  });
  GDALDriver& driver = file_.driver();
  if (!are_alike || !can_hold(driver, first.type)) {
    return {written_type(attributes_.fields()[field].type)};
  }
  return {first.type, can_hold(driver, first.subtype) ? first.subtype : OFSTNone};
}

const OGRFieldDefn& PolygonFile::source_field(std::size_t layer, int index) const {
  return *source_.layers()[layer].layer->GetLayerDefn()->GetFieldDefn(index);
}

void PolygonFile::write(const OGRFeature& feature, std::size_t layer_index,
                        std::unique_ptr<OGRGeometry> geometry) {
  const OGRFeatureUniquePtr out = file_.new_feature();
  out->SetField(id_field_, static_cast<GIntBig>(feature.GetFID()));
  if (layer_field_ >= 0) {
    out->SetField(layer_field_, source_.layers()[layer_index].layer->GetName());
  }
  set_attributes(feature, layer_index, *out);
  file_.write(*out, std::move(geometry));
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

}  // namespace trapeze
