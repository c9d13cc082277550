#include "tests/oracle/true_layer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

namespace trapeze::oracle {
namespace {

double area_of(const std::vector<Place>& places) {
  double doubled = 0;
  const Place origin = places.front();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Place a = places[i];
    const Place b = places[(i + 1) % places.size()];
    doubled += (a.x - origin.x) * (b.y - origin.y) - (b.x - origin.x) * (a.y - origin.y);
  }
  return std::abs(doubled) / 2;
}

void append_ring(const OGRLinearRing& ring, Map map, TruePart& part) {
  TrueRing read;
  for (int i = 0; i < ring.getNumPoints(); ++i) {
    read.places.push_back(place_of_lonlat(ring.getX(i), ring.getY(i), map));
    part.bounds.include(read.places.back());
  }
  if (read.places.empty()) return;
  const Place first = read.places.front();
  const Place last = read.places.back();
  if (read.places.size() > 1 && first.x == last.x && first.y == last.y) read.places.pop_back();
  read.extent = std::sqrt(area_of(read.places) * 4 / std::numbers::pi);
  part.rings.push_back(std::move(read));
}

void append_parts(const OGRGeometry* geometry, Map map, TrueFeature& feature) {
  if (geometry == nullptr) return;
  const OGRwkbGeometryType type = wkbFlatten(geometry->getGeometryType());
  if (type == wkbPolygon) {
    TruePart part;
    for (const OGRLinearRing* ring : *geometry->toPolygon()) append_ring(*ring, map, part);
    feature.bounds.include(part.bounds);
    feature.parts.push_back(std::move(part));
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
    for (const OGRGeometry* one : *geometry->toGeometryCollection()) {
      append_parts(one, map, feature);
    }
  }
}

}  // namespace

void Bounds::include(Place p) {
  include(Bounds{p.x, p.y, p.x, p.y});
}

void Bounds::include(const Bounds& other) {
  min_x = std::min(min_x, other.min_x);
  min_y = std::min(min_y, other.min_y);
  max_x = std::max(max_x, other.max_x);
  max_y = std::max(max_y, other.max_y);
}

bool Bounds::meets(const Bounds& other) const {
  return min_x <= other.max_x && max_x >= other.min_x && min_y <= other.max_y &&
         max_y >= other.min_y;
}

std::optional<std::string> TrueFeature::attribute(const std::string& name) const {
  const auto found = attributes.find(name);
  return found == attributes.end() ? std::nullopt : std::optional(found->second);
}

std::vector<Place> TrueLayer::vertices() const {
  std::vector<Place> all;
  for (const TrueFeature& feature : features) {
    for (const TruePart& part : feature.parts) {
      for (const TrueRing& ring : part.rings) {
        all.insert(all.end(), ring.places.begin(), ring.places.end());
      }
    }
  }
  return all;
}

TrueLayer read_layer(const std::string& source, const std::string& attribute, Map map) {
  GDALAllRegister();
  const GDALDatasetUniquePtr dataset(
      GDALDataset::Open(source.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
  if (dataset == nullptr) throw std::runtime_error("GDAL cannot open " + source);
  TrueLayer layer;
  for (const auto& row : *dataset->GetLayer(0)) {
    TrueFeature feature;
    feature.id = row->GetFID();
    const int field = row->GetFieldIndex(attribute.c_str());
    if (field >= 0 && row->IsFieldSetAndNotNull(field)) {
      feature.attributes[attribute] = row->GetFieldAsString(field);
    }
    append_parts(row->GetGeometryRef(), map, feature);
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

Place place_of_lonlat(double lon, double lat, Map map) {
  if (map == Map::degrees) return {lon / 360 + 0.5, 0.5 - lat / 360};
  const double radians = std::clamp(lat, -89.9, 89.9) * std::numbers::pi / 180;
  return {lon / 360 + 0.5, 0.5 - std::asinh(std::tan(radians)) / (2 * std::numbers::pi)};
}

}  // namespace trapeze::oracle
