#include "core/io/polygon_geometry.h"

#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/io/clip_ring.h"
#include "core/io/gdal_messages.h"
#include "core/web_mercator.h"

namespace trapeze {
namespace {

// GEOS looks at every hole of a polygon together with its shell: minutes for ten thousands.
constexpr std::size_t kMaxHolesToCheck = 2000;
// How far an edge may run beside its place on the Web Mercator map, in cells: tried in turn.
constexpr std::array kDeviations = {4096.0, 512.0, 64.0, 8.0, 1.0, 0.125, 0.015625};
// No polygon is worth more vertices than this.
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

/// How far the edge drawn straight in degrees passes from its middle on the map, in cells.
double deviation(Position a, Position b) {
  const Position low = degrees_of(a);
  const Position high = degrees_of(b);
  const GridPosition straight = grid_from_lonlat({(low.x + high.x) / 2, (low.y + high.y) / 2});
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  return length == 0 ? 0 : std::abs(straight.y - middle_of(a, b).y) * std::abs(b.x - a.x) / length;
}

/// Appends what comes after `a` up to and without `b`.
void subdivide(Position a, Position b, double limit, int halvings, PositionRing& cells) {
  if (halvings == 0 || deviation(a, b) <= limit) return;
  const Position middle = middle_of(a, b);
  subdivide(a, middle, limit, halvings - 1, cells);
  cells.push_back(middle);
  subdivide(middle, b, limit, halvings - 1, cells);
}

// The same vertices whatever the direction of an edge: the middle of it does not know.
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

std::unique_ptr<OGRPolygon> polygon_in_degrees(const OneOf& which, PolygonGeometry& result) {
  auto plain = plain_polygon(which, ExportCrs::degrees);
  if (which.end() - which.begin() > kMaxHolesToCheck + 1 || !OGRGeometryFactory::haveGEOS()) {
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

}  // namespace

PolygonGeometry geometry_of(const Polygons& polygons, ExportCrs crs) {
  PolygonGeometry result;
  const auto polygon = [&](std::size_t i) {
    const OneOf which{polygons, i};
    return crs == ExportCrs::degrees ? polygon_in_degrees(which, result)
                                     : plain_polygon(which, crs);
  };
  if (polygons.size() == 1) {
    result.geometry = polygon(0);
    return result;
  }
  auto all = std::make_unique<OGRMultiPolygon>();
  for (std::size_t i = 0; i < polygons.size(); ++i) all->addGeometryDirectly(polygon(i).release());
  result.geometry = std::move(all);
  return result;
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
