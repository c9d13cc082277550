// A layer as in its source, read with GDAL alone: nothing is cleaned, snapped or simplified.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace trapeze::oracle {

/// How the world is mapped to a square.
enum class Map {
  mercator,
  degrees,  // degrees of equal size; the poles are a quarter away from the square's north and south
};

/// On the square of a map: 0 is its western or northern edge, 1 its eastern or southern one.
struct Place {
  double x = 0;
  double y = 0;
};

struct Bounds {
  double min_x = std::numeric_limits<double>::infinity();
  double min_y = std::numeric_limits<double>::infinity();
  double max_x = -std::numeric_limits<double>::infinity();
  double max_y = -std::numeric_limits<double>::infinity();

  void include(Place p);
  void include(const Bounds& other);
  bool meets(const Bounds& other) const;
};

/// Closed by an edge from the last position to the first.
struct TrueRing {
  std::vector<Place> places;
  double extent = 0;  // the diameter of the circle that has its area
};

/// A polygon with its holes; the inside is even-odd over its rings.
struct TruePart {
  std::vector<TrueRing> rings;
  Bounds bounds;
};

/// The inside is the union of its parts.
struct TrueFeature {
  std::int64_t id = 0;
  std::map<std::string, std::string> attributes;  // without null values
  std::vector<TruePart> parts;
  Bounds bounds;

  std::optional<std::string> attribute(const std::string& name) const;
};

/// In the order of the source, which is the drawing order.
struct TrueLayer {
  std::vector<TrueFeature> features;

  /// Every vertex of the layer, one feature after the other.
  std::vector<Place> vertices() const;
};

/// The plane of a reference system known to PROJ, with the easting first, and the square of it that
/// is used. Polygons that do not meet `degrees` are left out; all others have to be on the plane.
struct Plane {
  std::string name;  // "EPSG:2056"
  double west = 0;   // in units of the plane, as are the others
  double north = 0;
  double side = 1;
  Bounds degrees = {};  // longitudes and latitudes
  double within =
      0;  // of a straight line on the plane, between points of an edge that is straight in degrees
};

/// The first layer of a source in longitude and latitude, with the attribute of that name only.
/// Throws std::runtime_error if it cannot be read.
TrueLayer read_layer(const std::string& source, const std::string& attribute,
                     Map map = Map::mercator);

/// The same on a plane. Also throws std::runtime_error if a position is not on it.
TrueLayer read_layer_on(const Plane& plane, const std::string& source,
                        const std::string& attribute);

Place place_of_lonlat(double lon, double lat, Map map = Map::mercator);

}  // namespace trapeze::oracle
