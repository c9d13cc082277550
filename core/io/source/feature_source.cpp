#include "core/io/source/feature_source.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "core/io/source/ring_reader.h"
#include "core/io/source/source_name.h"
#include "core/io/source/source_shortage.h"

namespace trapeze {
namespace {

constexpr std::string_view kOsmAreas = "multipolygons";

// Number of the first geometry field that can hold polygons, or -1.
int polygon_field(OGRFeatureDefn& definition) {
  for (int i = 0; i < definition.GetGeomFieldCount(); ++i) {
    if (can_hold_polygons(definition.GetGeomFieldDefn(i)->GetType())) return i;
  }
  return -1;
}

}  // namespace

FeatureSource::FeatureSource(const std::string& path, const SourceSelection& selection)
    : dataset_(open_source(path)), is_interleaved_(driver() == "OSM") {
  try {
    const std::string shortage = shortage_of_files(*dataset_);
    if (!shortage.empty()) throw SourceError(shortage);
    find_layers(selection);
  } catch (const SourceError& error) {
    throw std::runtime_error(name_of_source(path) + ": " + error.what());
  }
}

std::string FeatureSource::driver() const {
  return dataset_->GetDriverName();
}

void FeatureSource::find_layers(const SourceSelection& selection) {
  if (!selection.layer.empty()) {
    find_only_layer(selection.layer);
  } else {
    for (OGRLayer* layer : dataset_->GetLayers()) {
      const int field = polygon_field(*layer->GetLayerDefn());
      if (is_interleaved_ ? layer->GetName() == kOsmAreas : field >= 0) {
        add_layer(*layer, field);
      } else if (!is_interleaved_) {
        passed_over_ += static_cast<std::size_t>(std::max<GIntBig>(layer->GetFeatureCount(), 0));
      }
    }
  }
  count_stored();
  if (!selection.where.empty()) apply_condition(selection.where);
  for (const SourceLayer& layer : layers_) expect(*layer.layer);
  messages_.clear();
}

void FeatureSource::find_only_layer(const std::string& name) {
  OGRLayer* layer = dataset_->GetLayerByName(name.c_str());
  if (layer == nullptr) {
    std::string names;
    for (OGRLayer* other : dataset_->GetLayers()) {
      names += (names.empty() ? "" : ", ") + std::string(other->GetName());
    }
    throw SourceError("has no layer \"" + name + "\"; it has " + names);
  }
  const int field = polygon_field(*layer->GetLayerDefn());
  if (field < 0 || (is_interleaved_ && layer->GetName() != kOsmAreas)) {
    throw SourceError("its layer \"" + name + "\" holds no polygons");
  }
  add_layer(*layer, field);
}

void FeatureSource::add_layer(OGRLayer& layer, int geometry_field) {
  const OGRSpatialReference* reference =
      layer.GetLayerDefn()->GetGeomFieldDefn(geometry_field)->GetSpatialRef();
  layers_.push_back({&layer, geometry_field, SourceCrs::describe(reference)});
}

/// Before there is a condition, which the count would go by.
void FeatureSource::count_stored() {
  const bool is_told = tells_feature_count(driver());
  for (const SourceLayer& layer : layers_) {
    const bool is_stored = is_told && layer.layer->TestCapability(OLCFastFeatureCount) != 0;
    stored_.push_back(is_stored ? layer.layer->GetFeatureCount(FALSE) : -1);
  }
}

void FeatureSource::apply_condition(const std::string& where) {
  has_condition_ = true;
  for (const SourceLayer& layer : layers_) {
    messages_.clear();
    if (layer.layer->SetAttributeFilter(where.c_str()) != OGRERR_NONE) {
      throw SourceError("its layer \"" + std::string(layer.layer->GetName()) +
                        "\" cannot be asked where " + where + ": " + messages_.text());
    }
  }
}

void FeatureSource::expect(OGRLayer& layer) {
  const bool is_counted = layer.TestCapability(OLCFastFeatureCount) != 0;
  const GIntBig count = is_counted ? layer.GetFeatureCount(FALSE) : -1;
  expected_ = expected_ < 0 || count < 0 ? -1 : expected_ + static_cast<double>(count);
}

bool FeatureSource::next(SourceFeature& next) {
  messages_.clear();
  next.feature = is_interleaved_ ? next_interleaved(next) : next_of_layers(next);
  if (next.feature != nullptr) {
    ++read_;
    next.failure = messages_.has_failure() ? messages_.text() : std::string();
  }
  // One stream fails as a whole, though it may still give features from before that.
  if (messages_.has_failure() && (next.feature == nullptr || is_interleaved_)) {
    throw SourceError("breaks off after " + std::to_string(read_) +
                      " features: " + messages_.text());
  }
  return next.feature != nullptr;
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

/// A format may end anywhere without GDAL noticing, such as a FlatGeobuf between two features.
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
