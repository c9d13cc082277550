#include "tests/oracle/true_layer.h"

#include <algorithm>
#include <cmath>
#include <memory>
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

/// Maps the rings of a source to the square.
class Projection {
 public:
  virtual ~Projection() = default;
  /// Whether polygons with these longitudes and latitudes are needed.
  virtual bool wants(const OGREnvelope&) const { return true; }
  virtual std::vector<Place> places_of(const OGRLinearRing& ring) const = 0;
};

class OnMap : public Projection {
 public:
  explicit OnMap(Map map) : map_(map) {}
  std::vector<Place> places_of(const OGRLinearRing& ring) const override {
    std::vector<Place> places;
    for (int i = 0; i < ring.getNumPoints(); ++i) {
      places.push_back(place_of_lonlat(ring.getX(i), ring.getY(i), map_));
    }
    return places;
  }

 private:
  Map map_;
};

class OnPlane : public Projection {
 public:
  explicit OnPlane(const Plane& plane) : plane_(plane) {
    OGRSpatialReference lonlat;
    OGRSpatialReference reference;
    lonlat.SetWellKnownGeogCS("WGS84");
    if (reference.SetFromUserInput(plane.name.c_str()) != OGRERR_NONE) fail();
    for (OGRSpatialReference* one : {&lonlat, &reference}) {
      one->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    }
    transformation_.reset(OGRCreateCoordinateTransformation(&lonlat, &reference));
    if (transformation_ == nullptr) fail();
  }

  bool wants(const OGREnvelope& box) const override {
    return plane_.degrees.meets({box.MinX, box.MinY, box.MaxX, box.MaxY});
  }

  std::vector<Place> places_of(const OGRLinearRing& ring) const override {
    std::vector<Place> places;
    for (int i = 0; i < ring.getNumPoints(); ++i) {
      const Place lonlat{ring.getX(i), ring.getY(i)};
      const Place place = place_of(lonlat);
      if (i > 0) append_between(last_, lonlat, places.back(), place, places);
      places.push_back(place);
      last_ = lonlat;
    }
    return places;
  }

 private:
  static constexpr double kLongest = 0.5;  // degrees; a curve may cross its chord in the middle

  [[noreturn]] void fail() const {
    throw std::runtime_error("PROJ cannot project all to " + plane_.name);
  }

  Place place_of(Place lonlat) const {
    double x = lonlat.x;
    double y = lonlat.y;
    if (transformation_->Transform(1, &x, &y) == 0 || !std::isfinite(x + y)) fail();
    return {(x - plane_.west) / plane_.side, (plane_.north - y) / plane_.side};
  }

  /// Halves an edge until its middle is on the chord and it is short.
  void append_between(Place from, Place to, Place start, Place end,
                      std::vector<Place>& places) const {
    const Place half{(from.x + to.x) / 2, (from.y + to.y) / 2};
    const Place middle = place_of(half);
    const double off =
        std::hypot(middle.x - (start.x + end.x) / 2, middle.y - (start.y + end.y) / 2);
    const bool is_long = std::max(std::abs(to.x - from.x), std::abs(to.y - from.y)) > kLongest;
    if (!is_long && off * plane_.side <= plane_.within) return;
    append_between(from, half, start, middle, places);
    places.push_back(middle);
    append_between(half, to, middle, end, places);
  }

  Plane plane_;
  std::unique_ptr<OGRCoordinateTransformation> transformation_;
  mutable Place last_;
};

void append_ring(const OGRLinearRing& ring, const Projection& projection, TruePart& part) {
  TrueRing read{projection.places_of(ring)};
  for (const Place place : read.places) part.bounds.include(place);
  if (read.places.empty()) return;
  const Place first = read.places.front();
  const Place last = read.places.back();
  if (read.places.size() > 1 && first.x == last.x && first.y == last.y) read.places.pop_back();
  read.extent = std::sqrt(area_of(read.places) * 4 / std::numbers::pi);
  part.rings.push_back(std::move(read));
}

void append_parts(const OGRGeometry* geometry, const Projection& projection, TrueFeature& feature) {
  if (geometry == nullptr) return;
  const OGRwkbGeometryType type = wkbFlatten(geometry->getGeometryType());
  if (type == wkbPolygon) {
    OGREnvelope box;
    geometry->getEnvelope(&box);
    if (!projection.wants(box)) return;
    TruePart part;
    for (const OGRLinearRing* ring : *geometry->toPolygon()) append_ring(*ring, projection, part);
    feature.bounds.include(part.bounds);
    feature.parts.push_back(std::move(part));
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
    for (const OGRGeometry* one : *geometry->toGeometryCollection()) {
      append_parts(one, projection, feature);
    }
  }
}

TrueLayer read_projected(const Projection& projection, const std::string& source,
                         const std::string& attribute) {
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
    append_parts(row->GetGeometryRef(), projection, feature);
    layer.features.push_back(std::move(feature));
  }
  return layer;
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
  return read_projected(OnMap(map), source, attribute);
}

TrueLayer read_layer_on(const Plane& plane, const std::string& source,
                        const std::string& attribute) {
  return read_projected(OnPlane(plane), source, attribute);
}

Place place_of_lonlat(double lon, double lat, Map map) {
  if (map == Map::degrees) return {lon / 360 + 0.5, 0.5 - lat / 360};
  const double radians = std::clamp(lat, -89.9, 89.9) * std::numbers::pi / 180;
  return {lon / 360 + 0.5, 0.5 - std::asinh(std::tan(radians)) / (2 * std::numbers::pi)};
}

}  // namespace trapeze::oracle
