#include "bench/experiment/quality.h"

#include <geos_c.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bench/experiment/resimplifying.h"
#include "core/adapt/farthest_vertex.h"
#include "core/borders/polygons.h"
#include "core/sweep/graph_builder.h"

namespace trapeze::experiment {
namespace {

// GEOS compares every hole of a polygon with every other one: with tens of thousands this takes
// minutes.
constexpr std::size_t kMaxHolesForGeos = 2000;

using RingSide = std::pair<Point, Point>;

struct PointOrder {
  bool operator()(Point a, Point b) const { return is_above(a, b); }
};

/// Vertices and sides of rings, for look-up.
class RingBoundary {
 public:
  explicit RingBoundary(const Rings& rings) {
    points_ = rings.points;
    std::sort(points_.begin(), points_.end(), PointOrder());
    for (std::size_t r = 0; r < rings.size(); ++r) {
      const auto ring = rings[r];
      for (std::size_t i = 0; i < ring.size(); ++i) {
        sides_.push_back(in_order(ring[i], ring[(i + 1) % ring.size()]));
      }
    }
    std::sort(sides_.begin(), sides_.end(), is_before);
  }

  bool has(Point p) const {
    return std::binary_search(points_.begin(), points_.end(), p, PointOrder());
  }
  bool has(Point a, Point b) const {
    return std::binary_search(sides_.begin(), sides_.end(), in_order(a, b), is_before);
  }
  double squared_distance(Point p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : sides_) least = std::min(least, SegmentDistance(a, b).squared(p));
    return least;
  }

 private:
  static RingSide in_order(Point a, Point b) {
    return is_above(a, b) ? RingSide{a, b} : RingSide{b, a};
  }
  static bool is_before(const RingSide& a, const RingSide& b) {
    return a.first == b.first ? is_above(a.second, b.second) : is_above(a.first, b.first);
  }

  std::vector<Point> points_;
  std::vector<RingSide> sides_;
};

double area_of_ring(std::span<const Point> ring) {
  double doubled = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point a = ring[i];
    const Point b = ring[(i + 1) % ring.size()];
    // Relative to the first vertex, so that small rings far from the origin keep their precision.
    doubled += (static_cast<double>(a.x) - ring[0].x) * (static_cast<double>(b.y) - ring[0].y) -
               (static_cast<double>(b.x) - ring[0].x) * (static_cast<double>(a.y) - ring[0].y);
  }
  return std::abs(doubled) / 2;
}

double area_of_polygon(const Rings& rings, std::size_t first, std::size_t last) {
  double area = area_of_ring(rings[first]);
  for (std::size_t r = first + 1; r < last; ++r) area -= area_of_ring(rings[r]);
  return area;
}

double area_of(const TrapezoidalGraph& graph) {
  return static_cast<double>(graph.doubled_area()) / 2;
}

Rings some_rings(const Rings& rings, std::size_t first, std::size_t last) {
  Rings some;
  for (std::size_t r = first; r < last; ++r) some.add(rings[r]);
  return some;
}

/// Sums of absolute changes.
struct Areas {
  double before = 0;
  double changed = 0;

  void add(double from, double to) {
    before += from;
    changed += std::abs(from - to);
  }
};

/// The measurement of one view, with its input.
struct Measurement {
  const ScaledView& view;
  Quality quality;
  Areas areas;
};

void measure_resimplified(const MapLayer& layer, LayerSimplifier& simplifier, Measurement& m) {
  const PolygonSet& polygons = layer.polygons;
  SimplifiedPolygons simplified;
  const Box box = m.view.view.box();
  simplifier.simplify(box, m.view.epsilon(), simplified);
  m.quality.vertices += simplified.rings.points.size();
  std::size_t next = 0;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    if (!polygons.boxes[p].intersects(box)) continue;
    ++m.quality.polygons;
    const double area = area_of_polygon(polygons.rings, polygons.first_ring(p), polygons.ends[p]);
    if (next == simplified.size() || simplified.source[next] != p) {
      ++m.quality.gone;
      m.areas.add(area, 0);
      continue;
    }
    const std::uint32_t first = simplified.first_ring(next);
    const std::uint32_t last = simplified.ends[next];
    ++next;
    m.areas.add(area, area_of_polygon(simplified.rings, first, last));
    m.quality.invalid += is_valid_polygon(simplified.rings, first, last) ? 0 : 1;
    m.quality.hausdorff = std::max(
        m.quality.hausdorff,
        distance_between(some_rings(polygons.rings, polygons.first_ring(p), polygons.ends[p]),
                         some_rings(simplified.rings, first, last)));
  }
}

void measure_adapted(const TrapezoidalGraph& graph, const Rings& source, double area,
                     Measurement& m) {
  ++m.quality.polygons;
  const Rings left = rings_of(graph);
  m.areas.add(area, area_of(graph));
  m.quality.gone += left.empty() ? 1 : 0;
  m.quality.vertices += left.points.size();
  m.quality.hausdorff = std::max(m.quality.hausdorff, distance_between(source, left));
  const Polygons polygons = polygons_of(graph);
  bool is_valid = !polygons.is_noded && polygons.failure.empty();
  for (std::size_t p = 0; p < polygons.size() && is_valid; ++p) {
    is_valid = is_valid_polygon(polygons.rings, polygons.first_ring(p), polygons.ends[p]);
  }
  m.quality.invalid += is_valid ? 0 : 1;
}

/// A single graph is adapted to all views that intersect its box.
void measure_graph(Rings rings, const Box& box, Topology topology,
                   std::vector<Measurement>& measurements) {
  const auto is_seen = [&box](const Measurement& m) { return m.view.view.box().intersects(box); };
  if (std::none_of(measurements.begin(), measurements.end(), is_seen)) return;
  GraphBuilder builder;
  TrapezoidalGraph built;
  if (!builder.build(rings, built).built) return;
  const Rings source = rings_of(built);
  const double area = area_of(built);
  AdaptableGraph adaptable(std::move(built), {.topology = topology});
  for (Measurement& m : measurements) {
    if (!is_seen(m)) continue;
    adaptable.adapt_to(m.view.epsilon());
    measure_adapted(adaptable.graph(), source, area, m);
  }
}

void measure_graphs(const MapLayer& layer, Method method, Topology topology,
                    std::vector<Measurement>& measurements) {
  if (method == Method::adapting) {
    const PolygonSet& polygons = layer.polygons;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
      measure_graph(some_rings(polygons.rings, polygons.first_ring(p), polygons.ends[p]),
                    polygons.boxes[p], topology, measurements);
    }
    return;
  }
  for (const Rings& feature : layer.features) {
    Box around;
    for (const Point p : feature.points) around.include(p);
    measure_graph(feature, around, topology, measurements);
  }
}

/// The GEOS context of one thread.
class Geos {
 public:
  Geos() : handle_(GEOS_init_r()) {}
  ~Geos() { GEOS_finish_r(handle_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;

  bool is_valid(const Rings& rings, std::size_t first, std::size_t last) const {
    std::vector<GEOSGeometry*> holes;
    GEOSGeometry* shell = ring(rings[first]);
    for (std::size_t r = first + 1; r < last; ++r) holes.push_back(ring(rings[r]));
    GEOSGeometry* polygon =
        GEOSGeom_createPolygon_r(handle_, shell, holes.data(), static_cast<unsigned>(holes.size()));
    const bool is_valid = GEOSisValid_r(handle_, polygon) == 1;
    GEOSGeom_destroy_r(handle_, polygon);
    return is_valid;
  }

 private:
  GEOSGeometry* ring(std::span<const Point> points) const {
    const auto size = static_cast<unsigned>(points.size());
    GEOSCoordSequence* sequence = GEOSCoordSeq_create_r(handle_, size + 1, 2);
    for (unsigned i = 0; i <= size; ++i) {
      GEOSCoordSeq_setXY_r(handle_, sequence, i, points[i % size].x, points[i % size].y);
    }
    return GEOSGeom_createLinearRing_r(handle_, sequence);
  }

  GEOSContextHandle_t handle_;
};

}  // namespace

std::vector<Quality> measure_quality(Method method, Topology topology, const Map& map,
                                     std::span<const ScaledView> views) {
  std::vector<Measurement> measurements;
  for (const ScaledView& view : views) {
    Measurement& m = measurements.emplace_back(Measurement{view, {}, {}});
    m.quality.method = method;
    m.quality.topology = topology;
    m.quality.scale = view.scale;
    m.quality.tolerance = view.epsilon();
  }
  for (const MapLayer& layer : map.layers) {
    if (method == Method::douglas_peucker || method == Method::blg_tree) {
      LayerSimplifier simplifier(layer.polygons, make_ring_simplifier(method, layer.polygons),
                                 topology);
      for (Measurement& m : measurements) measure_resimplified(layer, simplifier, m);
    } else {
      measure_graphs(layer, method, topology, measurements);
    }
  }
  std::vector<Quality> all;
  for (Measurement& m : measurements) {
    if (m.areas.before > 0) m.quality.area_error = m.areas.changed / m.areas.before;
    all.push_back(m.quality);
  }
  return all;
}

// A removed vertex is at most as far from the boundary as from the chord that replaced it, if that
// exists; so most vertices need not be compared with all sides.
double distance_between(const Rings& source, const Rings& simplified) {
  const RingBoundary boundary(simplified);
  double greatest = 0;
  for (std::size_t r = 0; r < source.size(); ++r) {
    const auto ring = source[r];
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      if (boundary.has(ring[i])) kept.push_back(i);
    }
    if (kept.size() < 3) continue;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const std::size_t begin = kept[k];
      const std::size_t end = k + 1 < kept.size() ? kept[k + 1] : kept[0] + ring.size();
      const Point a = ring[begin];
      const Point b = ring[end % ring.size()];
      const SegmentDistance chord(a, b);
      const bool is_chord = boundary.has(a, b);
      for (std::size_t i = begin + 1; i < end; ++i) {
        const Point p = ring[i % ring.size()];
        if (is_chord && chord.squared(p) <= greatest) continue;
        greatest = std::max(greatest, boundary.squared_distance(p));
      }
    }
  }
  return std::sqrt(greatest);
}

bool is_valid_polygon(const Rings& rings, std::size_t first, std::size_t last) {
  thread_local const Geos geos;
  if (last - first <= kMaxHolesForGeos) return geos.is_valid(rings, first, last);
  Rings copy = some_rings(rings, first, last);
  TrapezoidalGraph graph;
  GraphBuilder builder;
  const BuildOutcome outcome = builder.build(copy, graph);
  return outcome.built && !outcome.noded;
}

}  // namespace trapeze::experiment
