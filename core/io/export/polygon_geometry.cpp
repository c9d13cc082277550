#include "core/io/export/polygon_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/grid/web_mercator.h"
#include "core/io/source/clip_ring.h"
#include "core/io/source/gdal_messages.h"

namespace trapeze {
namespace {

// GEOS compares every hole of a polygon with its shell: that takes minutes for tens of thousands.
constexpr std::size_t kMaxHolesToCheck = 2000;
// Maximum deviation of an edge from its course on the Web Mercator map, in cells; tried in turn.
constexpr std::array kDeviations = {4096.0, 512.0, 64.0, 8.0, 1.0, 0.125, 0.015625};
// No polygon gets more vertices than this.
constexpr std::size_t kMaxVertices = std::size_t{1} << 22;
constexpr int kMaxHalvings = 20;

Position metres_of(Position cell) {
  const GridPosition metres = metres_from_grid(cell.x, cell.y);
  return {metres.x, metres.y};
}

Position degrees_of(Position cell) {
  const LonLat degrees = lonlat_from_grid(cell.x, cell.y);
  return {degrees.lon, degrees.lat};
}

Position middle_of(Position a, Position b) {
  return {(a.x + b.x) / 2, (a.y + b.y) / 2};
}

/// The distance, in cells on the map, between the edge drawn straight in degrees and the edge's
/// middle.
double deviation(Position a, Position b) {
  const Position low = degrees_of(a);
  const Position high = degrees_of(b);
  const GridPosition straight = grid_from_lonlat({(low.x + high.x) / 2, (low.y + high.y) / 2});
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  return length == 0 ? 0 : std::abs(straight.y - middle_of(a, b).y) * std::abs(b.x - a.x) / length;
}

/// Appends the points between `a` and `b`, without the ends.
void subdivide(Position a, Position b, double limit, int halvings, PositionRing& cells) {
  if (halvings == 0 || deviation(a, b) <= limit) return;
  const Position middle = middle_of(a, b);
  subdivide(a, middle, limit, halvings - 1, cells);
  cells.push_back(middle);
  subdivide(middle, b, limit, halvings - 1, cells);
}

// The vertices do not depend on the direction of an edge, because its middle does not.
PositionRing subdivided(std::span<const Point> ring, double limit) {
  PositionRing cells;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Position a{static_cast<double>(ring[i].x), static_cast<double>(ring[i].y)};
    const Point next = ring[(i + 1) % ring.size()];
    cells.push_back(a);
    subdivide(a, {static_cast<double>(next.x), static_cast<double>(next.y)}, limit, kMaxHalvings,
              cells);
  }
  return cells;
}

PositionRing cells_of(std::span<const Point> ring) {
  PositionRing cells;
  cells.reserve(ring.size());
  for (const Point p : ring) cells.push_back({static_cast<double>(p.x), static_cast<double>(p.y)});
  return cells;
}

std::unique_ptr<OGRLinearRing> linear_ring(const PositionRing& cells, ExportCrs crs) {
  auto ring = std::make_unique<OGRLinearRing>();
  ring->setNumPoints(static_cast<int>(cells.size()) + 1, FALSE);
  for (std::size_t i = 0; i <= cells.size(); ++i) {
    const Position cell = cells[i % cells.size()];
    const Position p = crs == ExportCrs::degrees ? degrees_of(cell) : metres_of(cell);
    ring->setPoint(static_cast<int>(i), p.x, p.y);
  }
  return ring;
}

/// One of the polygons.
struct OneOf {
  const Polygons& polygons;
  std::size_t number;

  std::size_t begin() const { return polygons.first_ring(number); }
  std::size_t end() const { return polygons.ends[number]; }
};

std::unique_ptr<OGRPolygon> plain_polygon(const OneOf& which, ExportCrs crs) {
  auto polygon = std::make_unique<OGRPolygon>();
  for (std::size_t r = which.begin(); r < which.end(); ++r) {
    polygon->addRingDirectly(linear_ring(cells_of(which.polygons.rings[r]), crs).release());
  }
  return polygon;
}

std::size_t vertex_count(const OneOf& which) {
  std::size_t count = 0;
  for (std::size_t r = which.begin(); r < which.end(); ++r) count += which.polygons.rings[r].size();
  return count;
}

std::size_t vertex_count(const OGRPolygon& polygon) {
  std::size_t count = 0;
  for (const OGRLinearRing* ring : polygon) {
    count += static_cast<std::size_t>(ring->getNumPoints()) - 1;
  }
  return count;
}

/// Whether the validity of the polygon can be checked.
bool can_be_checked(const OneOf& which) {
  return which.end() - which.begin() <= kMaxHolesToCheck + 1 && OGRGeometryFactory::haveGEOS();
}

/// Null if there would be too many vertices.
std::unique_ptr<OGRPolygon> subdivided_polygon(const OneOf& which, double limit) {
  auto polygon = std::make_unique<OGRPolygon>();
  std::size_t vertices = 0;
  for (std::size_t r = which.begin(); r < which.end(); ++r) {
    const PositionRing cells = subdivided(which.polygons.rings[r], limit);
    vertices += cells.size();
    if (vertices > kMaxVertices) return nullptr;
    polygon->addRingDirectly(linear_ring(cells, ExportCrs::degrees).release());
  }
  return polygon;
}

bool is_valid(const OGRGeometry& geometry) {
  const GdalMessages unheard;  // GEOS's reason
  return geometry.IsValid() != 0;
}

/// Whether polygons that are valid by themselves are valid together; also true if that cannot be
/// checked.
bool are_valid_together(const Polygons& polygons, const OGRGeometry& geometry) {
  const std::size_t holes = polygons.rings.size() - polygons.size();
  const bool can_be_checked = holes <= kMaxHolesToCheck && OGRGeometryFactory::haveGEOS();
  return polygons.size() == 1 || !can_be_checked || is_valid(geometry);
}

std::unique_ptr<OGRPolygon> polygon_in_degrees(const OneOf& which, PolygonGeometry& result) {
  auto plain = plain_polygon(which, ExportCrs::degrees);
  if (!can_be_checked(which)) {
    ++result.unchecked;
    return plain;
  }
  if (is_valid(*plain)) return plain;
  for (const double limit : kDeviations) {
    auto finer = subdivided_polygon(which, limit);
    if (finer == nullptr) break;
    if (!is_valid(*finer)) continue;
    ++result.subdivided;
    return finer;
  }
  result.is_invalid = true;
  return plain;
}

/// A polygon, or a multipolygon if there are several: make(which) for each. Null if any result is
/// null.
template <typename Make>
std::unique_ptr<OGRGeometry> join_parts(const Polygons& polygons, const Make& make) {
  if (polygons.size() == 1) return make(OneOf{polygons, 0});
  auto all = std::make_unique<OGRMultiPolygon>();
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    auto part = make(OneOf{polygons, i});
    if (part == nullptr) return nullptr;
    all->addGeometryDirectly(part.release());
  }
  return all;
}

/// In degrees, with vertices along long edges; is_invalid if that is not enough. No geometry if it
/// would have too many vertices.
PolygonGeometry finer_geometry(const Polygons& polygons, double limit) {
  PolygonGeometry result;
  result.geometry = join_parts(polygons, [&](const OneOf& which) {
    auto polygon = subdivided_polygon(which, limit);
    if (polygon == nullptr) return polygon;
    result.subdivided += vertex_count(*polygon) > vertex_count(which);
    if (!can_be_checked(which)) {
      ++result.unchecked;
    } else if (!is_valid(*polygon)) {
      result.is_invalid = true;
    }
    return polygon;
  });
  const bool is_complete = result.geometry != nullptr && !result.is_invalid;
  if (is_complete && !are_valid_together(polygons, *result.geometry)) result.is_invalid = true;
  return result;
}

std::ptrdiff_t count_invalid(const std::vector<PolygonGeometry>& geometries) {
  return std::count_if(geometries.begin(), geometries.end(),
                       [](const PolygonGeometry& geometry) { return geometry.is_invalid; });
}

/// All with the same limit; empty if one would have too many vertices.
std::vector<PolygonGeometry> finer_geometries(std::span<const Polygons> neighbours, double limit) {
  std::vector<PolygonGeometry> finer;
  for (const Polygons& polygons : neighbours) {
    finer.push_back(polygons.empty() ? PolygonGeometry{} : finer_geometry(polygons, limit));
    if (!polygons.empty() && finer.back().geometry == nullptr) return {};
  }
  return finer;
}

}  // namespace

PolygonGeometry geometry_of(const Polygons& polygons, ExportCrs crs) {
  PolygonGeometry result;
  result.geometry = join_parts(polygons, [&](const OneOf& which) {
    return crs == ExportCrs::degrees ? polygon_in_degrees(which, result)
                                     : plain_polygon(which, crs);
  });
  if (crs != ExportCrs::degrees || result.is_invalid ||
      are_valid_together(polygons, *result.geometry)) {
    return result;
  }
  // An island near a long edge of another polygon.
  for (const double limit : kDeviations) {
    PolygonGeometry finer = finer_geometry(polygons, limit);
    if (finer.geometry == nullptr) break;
    if (!finer.is_invalid) return finer;
  }
  result.is_invalid = true;
  return result;
}

std::vector<PolygonGeometry> geometries_of_neighbours(std::span<const Polygons> neighbours,
                                                      ExportCrs crs) {
  std::vector<PolygonGeometry> plain;
  bool is_any_subdivided = false;
  for (const Polygons& polygons : neighbours) {
    plain.push_back(polygons.empty() ? PolygonGeometry{} : geometry_of(polygons, crs));
    is_any_subdivided = is_any_subdivided || plain.back().subdivided > 0;
  }
  if (!is_any_subdivided) return plain;
  // No limit helps a polygon whose vertices almost touch its edges. All the others still need the
  // same vertices as their neighbours: in `plain`, each has its own.
  std::vector<PolygonGeometry> best;
  for (const double limit : kDeviations) {
    std::vector<PolygonGeometry> finer = finer_geometries(neighbours, limit);
    if (finer.empty()) break;
    if (best.empty() || count_invalid(finer) < count_invalid(best)) best = std::move(finer);
    if (count_invalid(best) == 0) break;
  }
  return best.empty() ? std::move(plain) : std::move(best);
}

OGRSpatialReference reference_of(ExportCrs crs) {
  OGRSpatialReference reference;
  if (reference.importFromEPSG(crs == ExportCrs::degrees ? 4326 : 3857) != OGRERR_NONE) {
    throw std::runtime_error(
        "PROJ does not know the coordinate reference systems of EPSG; is its "
        "database installed?");
  }
  reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return reference;
}

}  // namespace trapeze
