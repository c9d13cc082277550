#include "core/io/source/feature_source.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <cpl_conv.h>
#include <cpl_vsi.h>

#include "core/io/source/attribute_reader.h"
#include "core/io/source/ring_reader.h"
#include "core/io/source/source_name.h"
#include "core/io/source/source_shortage.h"

namespace trapeze {
namespace {

constexpr std::string_view kOsmAreas = "multipolygons";

// Per layer. GDAL's GeoJSON driver compares all names for each value of a feature: with 40,000, a
// feature takes seconds. Databases support up to 2,000.
constexpr int kMostAttributes = 4096;

// Number of the first geometry field that can hold polygons, or -1.
int polygon_field(OGRFeatureDefn& definition) {
  for (int i = 0; i < definition.GetGeomFieldCount(); ++i) {
    if (can_hold_polygons(definition.GetGeomFieldDefn(i)->GetType())) return i;
  }
  return -1;
}

/// Quotes the name as databases do, whatever characters it contains.
std::string quoted_name(const std::string& name) {
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

// Random access to a feature takes at most so many times as long as sequential access.
constexpr std::size_t kCostByPlace = 8;

/// Whether layers of this driver accept any condition, and fail because of it only when they are
/// read.
bool is_asked_when_read(std::string_view driver) {
  return driver == "GPKG" || driver == "SQLite" || driver == "PostgreSQL";
}

/// Whether the driver parses many features at once, so that an error does not say which it
/// concerns.
bool is_read_ahead(std::string_view driver) {
  return driver == "GeoJSON" || driver == "TopoJSON" || driver == "ESRIJSON";
}

/// Past the quoted text, the name or the comment that begins there; `at` itself if nothing does.
std::size_t end_of_quoted(std::string_view sql, std::size_t at) {
  struct Quotes {
    std::string_view begin;
    std::string_view end;
  };
  static constexpr std::array<Quotes, 6> kQuotes = {
      {{"'", "'"}, {"\"", "\""}, {"`", "`"}, {"[", "]"}, {"--", "\n"}, {"/*", "*/"}}};
  for (const auto& [begin, end] : kQuotes) {
    if (sql.substr(at, begin.size()) != begin) continue;
    const std::size_t found = sql.find(end, at + begin.size());
    return found == std::string_view::npos ? sql.size() : found + end.size();
  }
  return at;
}

/// SQLite takes a name in double quotes for text if there is no such column, without a word: a
/// condition on a misspelt column would hold for every feature, or for none. In backquotes, a name
/// is always a name. Names that contain quotes stay as they are.
std::string with_names_in_backquotes(std::string_view where) {
  std::string text;
  for (std::size_t at = 0; at < where.size();) {
    const bool is_name = where[at] == '"';
    std::size_t end = std::max(end_of_quoted(where, at), at + 1);
    while (is_name && end < where.size() && where[end] == '"') end = end_of_quoted(where, end);
    const std::string_view piece = where.substr(at, end - at);
    at = end;
    if (is_name && piece.size() > 2 && piece.back() == '"' &&
        piece.find("\"\"") == std::string_view::npos && piece.find('`') == std::string_view::npos) {
      text.append("`").append(piece.substr(1, piece.size() - 2)).append("`");
    } else {
      text += piece;
    }
  }
  return text;
}

/// The condition in the words of the driver.
std::string condition_for(std::string_view driver, const std::string& where) {
  const bool is_sqlite = driver == "GPKG" || driver == "SQLite";
  return is_sqlite ? with_names_in_backquotes(where) : where;
}

/// A database would take what comes behind a semicolon for another statement: some pass over it
/// without a word, others do what it says.
bool has_several_statements(std::string_view where) {
  for (std::size_t at = 0; at < where.size();) {
    const std::size_t end = end_of_quoted(where, at);
    if (end == at && where[at] == ';') return true;
    at = std::max(end, at + 1);
  }
  return false;
}

}  // namespace

FeatureSource::FeatureSource(const std::string& path, const SourceSelection& selection)
    : dataset_(open_source(path, &warning_)), is_interleaved_(driver() == "OSM") {
  const std::string shortage = shortage_of_files(*dataset_);
  if (!shortage.empty()) throw std::runtime_error(name_of_source(path) + ": " + shortage);
  std::vector<SelectionProblem> problems = select(selection);
  if (!problems.empty()) throw SelectionError(name_of_source(path), std::move(problems));
  for (const SourceLayer& layer : layers_) {
    const int attributes = layer.layer->GetLayerDefn()->GetFieldCount();
    if (attributes <= kMostAttributes) continue;
    throw std::runtime_error(name_of_source(path) + ": has " + std::to_string(attributes) +
                             " attributes, of which there can be " +
                             std::to_string(kMostAttributes) +
                             " at most; `ogr2ogr -select` makes a copy with those that are needed");
  }
}

std::string FeatureSource::driver() const {
  return dataset_->GetDriverName();
}

/// Returns what the source lacks.
std::vector<SelectionProblem> FeatureSource::select(const SourceSelection& selection) {
  if (selection.layer.empty()) {
    find_layers();
  } else if (std::string problem = find_only_layer(selection.layer); !problem.empty()) {
    return {{SelectionPart::layer, 0, std::move(problem)}};
  }
  count_stored();
  std::vector<SelectionProblem> problems = find_missing_attributes(selection.attributes);
  if (std::string problem = apply_condition(selection.where); !problem.empty()) {
    problems.insert(problems.begin(), {SelectionPart::where, 0, std::move(problem)});
  }
  if (problems.empty() && selection.ids) select_ids(selection);
  for (const SourceLayer& layer : layers_) expect(*layer.layer);
  messages_.clear();
  return problems;
}

void FeatureSource::select_ids(const SourceSelection& selection) {
  if (layers_.size() != 1) {
    throw std::invalid_argument("features are read by id from one layer only");
  }
  has_condition_ = true;
  ids_ = selection.ids;
  condition_ = condition_for(driver(), selection.where);
  stored_.assign(1, -1);  // the number is unknown
}

void FeatureSource::find_layers() {
  for (OGRLayer* layer : dataset_->GetLayers()) {
    const int field = polygon_field(*layer->GetLayerDefn());
    if (is_interleaved_ ? layer->GetName() == kOsmAreas : field >= 0) {
      add_layer(*layer, field);
    } else if (!is_interleaved_) {
      passed_over_ += static_cast<std::size_t>(std::max<GIntBig>(layer->GetFeatureCount(), 0));
    }
  }
}

/// The problem with the name; empty if there is none.
std::string FeatureSource::find_only_layer(const std::string& name) {
  OGRLayer* layer = dataset_->GetLayerByName(name.c_str());
  if (layer == nullptr) {
    std::string names;
    for (OGRLayer* other : dataset_->GetLayers()) {
      names += (names.empty() ? "" : ", ") + std::string(other->GetName());
    }
    return "has no layer \"" + name + "\"; it has " + names;
  }
  const int field = polygon_field(*layer->GetLayerDefn());
  if (field < 0 || (is_interleaved_ && layer->GetName() != kOsmAreas)) {
    return "its layer \"" + name + "\" holds no polygons";
  }
  add_layer(*layer, field);
  return {};
}

void FeatureSource::add_layer(OGRLayer& layer, int geometry_field) {
  const OGRSpatialReference* reference =
      layer.GetLayerDefn()->GetGeomFieldDefn(geometry_field)->GetSpatialRef();
  layers_.push_back({&layer, geometry_field, SourceCrs::describe(reference)});
}

/// Must be called before a condition is set, because it would affect the count.
void FeatureSource::count_stored() {
  const bool is_told = tells_feature_count(driver());
  for (const SourceLayer& layer : layers_) {
    const bool is_stored = is_told && layer.layer->TestCapability(OLCFastFeatureCount) != 0;
    stored_.push_back(is_stored ? layer.layer->GetFeatureCount(FALSE) : -1);
  }
}

/// The reason why a layer cannot be queried; empty if all can.
std::string FeatureSource::apply_condition(const std::string& where) {
  if (where.empty()) return {};
  if (has_several_statements(where)) {
    return "cannot be asked where " + where + ": there is a semicolon in it, outside of quotes";
  }
  has_condition_ = true;
  for (const SourceLayer& layer : layers_) {
    const std::string failure = apply_condition(where, *layer.layer);
    if (failure.empty()) continue;
    std::string words = "its layer \"";
    words.append(layer.layer->GetName()).append("\" cannot be asked where ");
    return words.append(where).append(": ").append(failure);
  }
  return {};
}

std::string FeatureSource::apply_condition(const std::string& where, OGRLayer& layer) {
  messages_.clear();
  const std::string condition = condition_for(driver(), where);
  if (layer.SetAttributeFilter(condition.c_str()) != OGRERR_NONE) return messages_.text();
  if (!is_asked_when_read(driver())) return {};
  const OGRFeatureUniquePtr first(layer.GetNextFeature());
  layer.ResetReading();
  return messages_.has_failure() ? messages_.text() : std::string();
}

std::vector<SelectionProblem> FeatureSource::find_missing_attributes(
    const std::optional<std::vector<std::string>>& names) const {
  AttributeReader attributes(names);
  for (const SourceLayer& layer : layers_) attributes.add_layer(*layer.layer->GetLayerDefn());
  std::vector<SelectionProblem> problems;
  for (const std::size_t index : attributes.missing()) {
    problems.push_back(
        {SelectionPart::attributes, index, "has no attribute \"" + (*names)[index] + "\""});
  }
  return problems;
}

void FeatureSource::expect(OGRLayer& layer) {
  const bool is_counted = layer.TestCapability(OLCFastFeatureCount) != 0;
  const GIntBig count = is_counted ? layer.GetFeatureCount(FALSE) : -1;
  expected_ = expected_ < 0 || count < 0 ? -1 : expected_ + static_cast<double>(count);
}

std::vector<std::string> FeatureSource::warnings() const {
  std::vector<std::string> warnings;
  // Such as that integers beyond 64 bits all become the same one, or that the reference system is
  // unknown, for which GDAL takes WGS 84. An error in a geometry is met again when it is read.
  if (!warning_.empty() && warning_ != failure_ahead_ && driver().starts_with("GeoJSON")) {
    warnings.push_back("is not read as it is written: " + warning_);
  }
  if (!failure_ahead_.empty()) {
    warnings.push_back("cannot be read as a whole: " + failure_ahead_);
  }
  for (const SourceLayer& layer : layers_) {
    // Each .dbf has a column, if only one of numbers.
    if (driver() != "ESRI Shapefile" || layer.layer->GetLayerDefn()->GetFieldCount() > 0) continue;
    warnings.push_back("its layer \"" + std::string(layer.layer->GetName()) +
                       "\" has no .dbf, so its features have no attributes");
  }
  if (driver() == "TopoJSON") return warnings;  // its coordinates are degrees, if possible
  for (const SourceLayer& layer : layers_) {
    if (layer.crs.kind != SourceCrs::Kind::assumed_degrees) continue;
    const std::string which =
        layers_.size() == 1 ? "" : "its layer \"" + std::string(layer.layer->GetName()) + "\" ";
    warnings.push_back(
        which + "names no coordinate reference system" +
        (has_unknown_prj() ? " that is known" : "") +
        ", so its coordinates are assumed to be degrees on WGS 84; if they are not, " +
        crs_advice(driver()));
  }
  return warnings;
}

/// Whether there is a .prj beside a Shapefile; GDAL does not report one that it does not
/// understand.
bool FeatureSource::has_unknown_prj() const {
  if (driver() != "ESRI Shapefile") return false;
  VSIStatBufL status;
  return VSIStatL(CPLResetExtension(dataset_->GetDescription(), "prj"), &status) == 0 ||
         VSIStatL(CPLResetExtension(dataset_->GetDescription(), "PRJ"), &status) == 0;
}

void FeatureSource::check_reference_systems() const {
  for (const SourceLayer& layer : layers_) {
    const RingReader reader(layer.crs, {});  // throws if it cannot be projected
    OGREnvelope extent;
    if (layer.crs.kind != SourceCrs::Kind::assumed_degrees ||
        layer.layer->GetExtent(layer.geometry_field, &extent, FALSE) != OGRERR_NONE) {
      continue;
    }
    const bool are_degrees = extent.MinX >= -180 - kDegreeSlack &&
                             extent.MaxX <= 180 + kDegreeSlack &&
                             extent.MinY >= -90 - kDegreeSlack && extent.MaxY <= 90 + kDegreeSlack;
    if (!are_degrees) throw SourceError(no_degrees_words(driver()));
  }
}

void FeatureSource::keep_only(std::function<bool(std::size_t order)> is_wanted, std::size_t about) {
  is_wanted_ = std::move(is_wanted);
  reads_by_place_ =
      knows_places() && about < static_cast<std::size_t>(stored_.front()) / kCostByPlace;
}

/// Whether the features of the only layer are numbered as they are stored, and an index has the
/// position of each.
bool FeatureSource::knows_places() const {
  return driver() == "FlatGeobuf" && layers_.size() == 1 && !has_condition_ &&
         stored_.front() > 0 && layers_.front().layer->TestCapability(OLCRandomRead) != 0;
}

bool FeatureSource::next(SourceFeature& next) {
  while (read_next(next)) {
    if (!is_wanted_ || is_wanted_(read_ - 1)) return true;
  }
  return false;
}

bool FeatureSource::read_next(SourceFeature& next) {
  messages_.clear();
  next.feature = is_interleaved_   ? next_interleaved(next)
                 : ids_            ? next_by_id(next)
                 : reads_by_place_ ? next_by_place(next)
                                   : next_of_layers(next);
  if (next.feature != nullptr) {
    ++read_;
    next.failure = messages_.has_failure() ? messages_.text() : std::string();
    next.follows_lost_lines =
        driver() == "GeoJSONSeq" && next.failure.starts_with("JSON parsing error");
    const bool has_failed = !next.failure.empty() || !failure_ahead_.empty();
    if (has_failed && is_read_ahead(driver())) assign_failure_ahead(next);
  }
  // An interleaved stream fails as a whole, though it may still return features from before that.
  if (messages_.has_failure() && (next.feature == nullptr || is_interleaved_)) {
    throw SourceError("breaks off after " + std::to_string(read_) +
                      " features: " + messages_.text());
  }
  return next.feature != nullptr;
}

/// The error may concern any feature of the block that was parsed; those without a geometry are the
/// ones that could not be read.
void FeatureSource::assign_failure_ahead(SourceFeature& next) {
  if (!next.failure.empty()) failure_ahead_ = next.failure;
  const bool has_geometry =
      next.layer != nullptr && next.feature->GetGeomFieldRef(next.layer->geometry_field) != nullptr;
  next.failure = has_geometry || failure_ahead_.empty()
                     ? std::string()
                     : "has no geometry, or one that cannot be read: " + failure_ahead_;
}

/// The next wanted feature. Features that were passed over count as read.
OGRFeatureUniquePtr FeatureSource::next_by_place(SourceFeature& next) {
  const auto count = static_cast<std::size_t>(stored_.front());
  while (read_ < count && !is_wanted_(read_)) ++read_;
  if (read_ >= count) return nullptr;
  next.layer = &layers_.front();
  next.layer_index = 0;
  OGRFeatureUniquePtr feature(next.layer->layer->GetFeature(static_cast<GIntBig>(read_)));
  if (feature == nullptr && !messages_.has_failure()) {
    throw SourceError("is truncated or damaged: feature " + std::to_string(read_) + " of the " +
                      std::to_string(count) + " of its layer \"" + next.layer->layer->GetName() +
                      "\" cannot be read");
  }
  return feature;
}

OGRFeatureUniquePtr FeatureSource::next_by_id(SourceFeature& next) {
  next.layer = &layers_.front();
  next.layer_index = 0;
  if (read_ == 0 && by_id_.empty()) read_by_id(*next.layer->layer);
  if (messages_.has_failure() || read_ == by_id_.size()) return nullptr;
  return std::move(by_id_[read_]);
}

/// In several queries, because a database limits the length of a condition.
void FeatureSource::read_by_id(OGRLayer& layer) {
  constexpr std::size_t kAtOnce = 1000;
  const std::string column = layer.GetFIDColumn();
  const std::string id = is_asked_when_read(driver()) ? quoted_name(column) : "FID";
  std::unordered_map<GIntBig, OGRFeatureUniquePtr> found;
  for (std::size_t begin = 0; begin < ids_->size(); begin += kAtOnce) {
    std::string condition = condition_.empty() ? "" : "(" + condition_ + ") AND ";
    condition += id + " IN (";
    for (std::size_t i = begin; i < std::min(begin + kAtOnce, ids_->size()); ++i) {
      condition += (i == begin ? "" : ",") + std::to_string((*ids_)[i]);
    }
    if (layer.SetAttributeFilter((condition + ")").c_str()) != OGRERR_NONE) return;
    while (OGRFeatureUniquePtr feature{layer.GetNextFeature()}) {
      const GIntBig found_id = feature->GetFID();
      found[found_id] = std::move(feature);
    }
    if (messages_.has_failure()) return;
  }
  for (const std::int64_t wanted : *ids_) {
    const auto feature = found.find(wanted);
    if (feature == found.end() || feature->second == nullptr) continue;
    by_id_.push_back(std::move(feature->second));
  }
}

OGRFeatureUniquePtr FeatureSource::next_of_layers(SourceFeature& next) {
  for (; current_layer_ < layers_.size(); ++current_layer_) {
    next.layer = &layers_[current_layer_];
    next.layer_index = current_layer_;
    OGRFeatureUniquePtr feature(next.layer->layer->GetNextFeature());
    if (feature != nullptr) ++read_of_layer_;
    if (feature != nullptr || messages_.has_failure()) return feature;
    check_all_was_read();
    read_of_layer_ = 0;
  }
  return nullptr;
}

/// A format may end anywhere without GDAL noticing, for example a FlatGeobuf between two features.
void FeatureSource::check_all_was_read() {
  OGRLayer& layer = *layers_[current_layer_].layer;
  const GIntBig stored = stored_[current_layer_];
  if (read_of_layer_ >= stored) return;
  const GIntBig readable = has_condition_ ? count_readable(layer) : read_of_layer_;
  if (readable >= stored || messages_.has_failure()) return;
  throw SourceError("is cut off or damaged: " + std::to_string(readable) + " of the " +
                    std::to_string(stored) + " features of its layer \"" + layer.GetName() +
                    "\" can be read");
}

OGRFeatureUniquePtr FeatureSource::next_interleaved(SourceFeature& next) {
  OGRLayer* layer = nullptr;
  OGRFeatureUniquePtr feature(
      dataset_->GetNextFeature(&layer, &interleaved_share_, nullptr, nullptr));
  const auto known = std::find_if(layers_.begin(), layers_.end(),
                                  [layer](const SourceLayer& l) { return l.layer == layer; });
  next.layer = known == layers_.end() ? nullptr : &*known;
  next.layer_index = static_cast<std::size_t>(known - layers_.begin());
  return feature;
}

double FeatureSource::progress() const {
  if (is_interleaved_) return std::min(interleaved_share_, 1.0);
  if (expected_ < 0) return -1;
  if (expected_ == 0) return 1;
  return std::min(static_cast<double>(read_) / expected_, 1.0);
}

}  // namespace trapeze
