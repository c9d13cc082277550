#include "core/io/feature_source.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/io/ring_reader.h"

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

FeatureSource::FeatureSource(const std::string& path)
    : dataset_(open_source(path)), is_interleaved_(driver() == "OSM") {
  find_layers();
}

std::string FeatureSource::driver() const {
  return dataset_->GetDriverName();
}

void FeatureSource::find_layers() {
  for (OGRLayer* layer : dataset_->GetLayers()) {
    const int field = polygon_field(*layer->GetLayerDefn());
    if (is_interleaved_ ? layer->GetName() == kOsmAreas : field >= 0) {
      const OGRSpatialReference* reference =
          layer->GetLayerDefn()->GetGeomFieldDefn(field)->GetSpatialRef();
      layers_.push_back({layer, field, SourceCrs::describe(reference)});
      expect(*layer);
    } else if (!is_interleaved_) {
      passed_over_ += static_cast<std::size_t>(std::max<GIntBig>(layer->GetFeatureCount(), 0));
    }
  }
  messages_.clear();
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
    return true;
  }
  if (messages_.has_failure()) {
    throw SourceError("breaks off after " + std::to_string(read_) +
                      " features: " + messages_.text());
  }
  return false;
}

OGRFeatureUniquePtr FeatureSource::next_of_layers(SourceFeature& next) {
  for (; current_layer_ < layers_.size(); ++current_layer_) {
    next.layer = &layers_[current_layer_];
    next.layer_index = current_layer_;
    OGRFeatureUniquePtr feature(next.layer->layer->GetNextFeature());
    if (feature != nullptr || messages_.has_failure()) return feature;
  }
  return nullptr;
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
