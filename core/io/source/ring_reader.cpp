#include "core/io/source/ring_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/grid/web_mercator.h"
#include "core/io/source/unwrap_longitudes.h"

namespace trapeze {
namespace {

constexpr ClipWindow kWorld = {static_cast<double>(kGridMin), static_cast<double>(kGridMin),
                               static_cast<double>(kGridMax), static_cast<double>(kGridMax)};

// Geometry farther from the prime meridian is not moved back into the world.
constexpr double kMostLongitude = 540;

bool is_collection(OGRwkbGeometryType flat) {
  return OGR_GT_IsSubClassOf(flat, wkbGeometryCollection) != 0;
}

bool is_polyhedral(OGRwkbGeometryType flat) {
  return OGR_GT_IsSubClassOf(flat, wkbPolyhedralSurface) != 0;
}

bool is_polygon(OGRwkbGeometryType flat) {
  return OGR_GT_IsSubClassOf(flat, wkbCurvePolygon) != 0;
}

// Positive if the ring runs counterclockwise on a map with north up. Computed relative to the first
// vertex, so that small rings at large coordinates keep their precision.
double twice_area(std::span<const double> x, std::span<const double> y) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    sum += (x[i] - x[0]) * (y[i + 1] - y[0]) - (x[i + 1] - x[0]) * (y[i] - y[0]);
  }
  return sum;
}

bool are_finite(std::span<const double> values) {
  // Zero times any finite number is zero; infinities and NaN turn the sum into NaN.
  double sum = 0;
  for (const double value : values) sum += value * 0.0;
  return sum == 0;
}

bool are_within(std::span<const double> values, double limit) {
  return std::all_of(values.begin(), values.end(),
                     [limit](double value) { return std::abs(value) <= limit; });
}

constexpr auto kTurn = static_cast<double>(kGridSize);  // around the world, in cells
constexpr double kTurnDegrees = 360;
constexpr double kHalfTurnDegrees = 180;

constexpr double kNearSeam = 2e-5;      // degrees: two metres, the precision to which sources round
                                        // 180
constexpr double kLeastSeamCut = 0.01;  // degrees: a kilometre; shorter edges may belong to a
                                        // building

// Sources cut geometry that continues beyond 180 degrees, sometimes with rounding: 179.99999. Edges
// along the cut are moved onto it, so that both sides meet and it is recognized as a cut.
void lay_cuts_on_seam(PositionRing& ring) {
  const auto is_near = [](Position p) { return std::abs(std::abs(p.x) - 180) <= kNearSeam; };
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Position& from = ring[i];
    Position& to = ring[i + 1 == ring.size() ? 0 : i + 1];
    const bool is_cut = is_near(from) && is_near(to) && (from.x > 0) == (to.x > 0) &&
                        std::abs(to.y - from.y) >= kLeastSeamCut;
    if (is_cut) from.x = to.x = std::copysign(180.0, from.x);
  }
}

// Appends the ring rounded to cells, each coordinate to the nearest and halves to even, without
// consecutive duplicates; nothing if the ring is empty. All positions lie in the world.
void append_snapped(const PositionRing& ring, Rings& rings) {
  const std::size_t begin = rings.points.size();
  for (const Position p : ring) {
    const Point point{static_cast<std::int32_t>(std::lrint(p.x)),
                      static_cast<std::int32_t>(std::lrint(p.y))};
    if (rings.points.size() > begin && rings.points.back() == point) continue;
    rings.points.push_back(point);
  }
  while (rings.points.size() > begin + 1 && rings.points.back() == rings.points[begin]) {
    rings.points.pop_back();
  }
  if (rings.points.size() > begin) rings.close_ring();
}

struct Extent {
  double min_x = std::numeric_limits<double>::infinity();
  double min_y = std::numeric_limits<double>::infinity();
  double max_x = -std::numeric_limits<double>::infinity();
  double max_y = -std::numeric_limits<double>::infinity();
};

Extent extent_of(const PositionRing& ring) {
  Extent extent;
  for (const Position p : ring) {
    extent.min_x = std::min(extent.min_x, p.x);
    extent.min_y = std::min(extent.min_y, p.y);
    extent.max_x = std::max(extent.max_x, p.x);
    extent.max_y = std::max(extent.max_y, p.y);
  }
  return extent;
}

}  // namespace

void FeatureRings::clear() {
  rings.clear();
  part_ends.clear();
  polygons = source_rings = vertices = 0;
  failure.clear();
  has_wrong_units = false;
}

bool can_hold_polygons(OGRwkbGeometryType type) {
  const OGRwkbGeometryType flat = wkbFlatten(type);
  return flat == wkbUnknown || flat == wkbSurface || flat == wkbGeometryCollection ||
         flat == wkbMultiPolygon || flat == wkbMultiSurface || is_polygon(flat) ||
         is_polyhedral(flat);
}

bool has_polygons(const OGRGeometry& geometry) {
  const OGRwkbGeometryType flat = wkbFlatten(geometry.getGeometryType());
  if (flat != wkbGeometryCollection) return can_hold_polygons(flat);
  const OGRGeometryCollection& parts = *geometry.toGeometryCollection();
  return std::any_of(parts.begin(), parts.end(),
                     [](const OGRGeometry* part) { return has_polygons(*part); });
}

RingReader::RingReader(const SourceCrs& crs, Options options)
    : crs_(crs), options_(std::move(options)) {
  if (crs.kind == SourceCrs::Kind::geographic || crs.kind == SourceCrs::Kind::projected) {
    transform_ = std::make_unique<LonLatTransform>(crs);
  }
  if (options_.grid != nullptr) grid_ = std::make_unique<GridRings>(options_.grid);
}

void RingReader::read(const OGRGeometry& geometry, FeatureRings& feature) {
  feature.clear();
  x_.clear();
  y_.clear();
  ends_.clear();
  part_ends_.clear();
  collect(geometry, feature);
  check_coordinates(feature);
  if (feature.failure.empty() && grid_ != nullptr) cut_source_edges(feature);
  if (feature.failure.empty() && transform_ != nullptr) to_lonlat(feature);
  if (!feature.failure.empty()) return;
  feature.rings.points.reserve(x_.size());
  turns_.clear();
  const auto begin_part = [this] {
    west_ = std::numeric_limits<double>::infinity();
    east_ = -west_;
  };
  begin_part();
  std::size_t begin = 0;
  std::size_t part = 0;
  std::size_t first_of_part = 0;
  for (std::size_t ring = 0; ring < ends_.size(); ++ring) {
    const bool begins_part = ring == 0 || (part > 0 && ring == part_ends_[part - 1]);
    if (grid_ != nullptr && begins_part) {
      note_extent(begin, part < part_ends_.size() ? ends_[part_ends_[part] - 1] : x_.size());
    }
    append_ring(begin, ends_[ring], feature);
    if (!feature.failure.empty()) return feature.rings.clear();
    begin = ends_[ring];
    if (part == part_ends_.size() || ring + 1 < part_ends_[part]) continue;
    separate_turns(first_of_part, feature);
    feature.part_ends.push_back(static_cast<std::uint32_t>(feature.rings.size()));
    first_of_part = feature.rings.size();
    begin_part();
    ++part;
  }
  if (part_ends_.empty()) {
    separate_turns(0, feature);
    // Its turns are parts even if the source does not name any.
    const auto end = static_cast<std::uint32_t>(feature.rings.size());
    if (!feature.part_ends.empty() && feature.part_ends.back() < end) {
      feature.part_ends.push_back(end);
    }
  }
  if (feature.rings.empty()) check_degrees(feature);
}

void RingReader::collect(const OGRGeometry& geometry, FeatureRings& feature) {
  const OGRwkbGeometryType flat = wkbFlatten(geometry.getGeometryType());
  if (flat == wkbPolygon || flat == wkbTriangle) {
    collect_polygon(*geometry.toPolygon(), feature);
  } else if (is_polygon(flat)) {
    const std::unique_ptr<OGRGeometry> linear(geometry.getLinearGeometry());
    collect_polygon(*linear->toPolygon(), feature);
  } else if (is_polyhedral(flat)) {
    for (const OGRPolygon* part : *geometry.toPolyhedralSurface()) collect_polygon(*part, feature);
  } else if (is_collection(flat)) {
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) collect(*part, feature);
  }
}

void RingReader::collect_polygon(const OGRPolygon& polygon, FeatureRings& feature) {
  if (polygon.IsEmpty()) return;
  const std::size_t polygons_before = feature.polygons;
  for (const OGRLinearRing* ring : polygon) collect_ring(*ring, feature);
  if (options_.shells_are_clockwise) return;
  feature.polygons = polygons_before + 1;
  if (part_ends_.empty() || part_ends_.back() < ends_.size()) part_ends_.push_back(ends_.size());
}

void RingReader::collect_ring(const OGRLinearRing& ring, FeatureRings& feature) {
  const std::size_t begin = x_.size();
  const auto count = static_cast<std::size_t>(ring.getNumPoints());
  if (count == 0) return;
  x_.resize(begin + count);
  y_.resize(begin + count);
  ring.getPoints(x_.data() + begin, sizeof(double), y_.data() + begin, sizeof(double));
  ends_.push_back(x_.size());
  feature.source_rings += 1;
  feature.vertices += count;
  if (options_.shells_are_clockwise &&
      twice_area(std::span(x_).subspan(begin), std::span(y_).subspan(begin)) <= 0) {
    feature.polygons += 1;
  }
}

void RingReader::check_coordinates(FeatureRings& feature) const {
  if (!are_finite(x_) || !are_finite(y_)) {
    feature.failure = "has a coordinate that is not a finite number";
  } else if (crs_.kind == SourceCrs::Kind::assumed_degrees &&
             !(are_within(x_, 180 + kDegreeSlack) && are_within(y_, 90 + kDegreeSlack))) {
    feature.failure = "has coordinates that are not degrees";
    feature.has_wrong_units = true;
  }
}

// For coordinates outside the world: whether the source declares degrees although it contains
// metres.
void RingReader::check_degrees(FeatureRings& feature) const {
  const bool is_said =
      crs_.kind == SourceCrs::Kind::degrees || crs_.kind == SourceCrs::Kind::geographic;
  const bool can_be = are_within(x_, kMostLongitude) && are_within(y_, 90 + kDegreeSlack);
  if (is_said && !can_be) {
    feature.failure = "has coordinates that are not degrees, contrary to its source";
  }
}

void RingReader::to_lonlat(FeatureRings& feature) {
  source_x_ = x_;
  source_y_ = y_;
  feature.failure = transform_->apply(x_, y_);
  if (!feature.failure.empty()) return;
  if (!are_finite(x_) || !are_finite(y_)) {
    feature.failure = "lies where its coordinate reference system is not defined";
    return;
  }
  if (crs_.degrees_per_unit == 0) return;
  // A datum shift moves a point by metres: a longitude that moved by half a turn was wrapped.
  for (std::size_t i = 0; i < x_.size(); ++i) {
    x_[i] += 360 * std::nearbyint((source_x_[i] * crs_.degrees_per_unit - x_[i]) / 360);
  }
}

bool RingReader::map_to_lonlat(std::vector<double>& x, std::vector<double>& y) {
  if (transform_ != nullptr) {
    return transform_->apply(x, y).empty() && are_finite(x) && are_finite(y);
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const GridPosition cell = grid_from_metres(x[i], y[i]);
    const LonLat place = lonlat_from_grid(cell.x, cell.y);
    x[i] = place.lon;
    y[i] = place.lat;
  }
  return true;
}

// Edges that are straight on a plane are curves in degrees. A ring that cannot be cut is left
// unchanged, and is reported when all of it is transformed to degrees.
void RingReader::cut_source_edges(FeatureRings& feature) {
  const bool is_plane =
      crs_.kind == SourceCrs::Kind::projected || crs_.kind == SourceCrs::Kind::web_mercator;
  if (!is_plane) return;
  const PointMap map = [this](std::vector<double>& x, std::vector<double>& y) {
    return map_to_lonlat(x, y);
  };
  std::vector<double> x;
  std::vector<double> y;
  std::size_t begin = 0;
  for (std::size_t& end : ends_) {
    MappedRing ring;
    for (std::size_t i = begin; i < end; ++i) ring.before.push_back({x_[i], y_[i]});
    begin = end;
    const PositionRing whole = ring.before;
    if (!cut_edges(ring, map, metres_of_degrees, GridRings::kMostOffMetres)) ring.before = whole;
    for (const Position p : ring.before) {
      x.push_back(p.x);
      y.push_back(p.y);
    }
    end = x.size();
  }
  x_.swap(x);
  y_.swap(y);
  if (transform_ == nullptr && !map_to_lonlat(x_, y_)) {
    feature.failure = "lies where its coordinate reference system is not defined";
  }
}

/// For the grid of another system: from where to where a part extends, in degrees.
void RingReader::note_extent(std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    west_ = std::min(west_, x_[i]);
    east_ = std::max(east_, x_[i]);
  }
}

bool RingReader::is_longer_than_world() const {
  return east_ - west_ > (grid_ != nullptr ? kTurnDegrees + 2 * kNearSeam : kTurn);
}

void RingReader::append_on_grid(FeatureRings& feature) {
  if (!is_longer_than_world()) return append_parts_on_grid(ring_, 0, feature);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Extent extent = extent_of(ring_);
  for (const double turn : {0.0, -kTurn, kTurn}) {
    const double shift = turn / kTurn * kTurnDegrees;
    const bool is_seen =
        extent.min_x + shift < kHalfTurnDegrees && extent.max_x + shift > -kHalfTurnDegrees;
    if (!is_seen) continue;
    clipped_.clear();
    for (const Position p : ring_) clipped_.push_back({p.x + shift, p.y});
    clip_ring(clipped_, {-kHalfTurnDegrees, -kInfinity, kHalfTurnDegrees, kInfinity}, scratch_);
    if (feature.failure.empty()) append_parts_on_grid(clipped_, turn, feature);
  }
}

void RingReader::append_parts_on_grid(const PositionRing& ring, double turn,
                                      FeatureRings& feature) {
  if (!grid_->project(ring, parts_)) {
    feature.failure = "lies where " + grid_->grid().name + " is not defined";
    return;
  }
  for (const PositionRing& part : parts_) append_snapped(part, feature.rings);
  turns_.resize(feature.rings.size(), turn);
}

void RingReader::append_ring(std::size_t begin, std::size_t end, FeatureRings& feature) {
  // The closing vertex repeats the first one; a ring without it is closed too.
  if (end - begin > 1 && x_[begin] == x_[end - 1] && y_[begin] == y_[end - 1]) --end;
  ring_.clear();
  for (std::size_t i = begin; i < end; ++i) ring_.push_back({x_[i], y_[i]});
  if (crs_.kind == SourceCrs::Kind::projected) unwrap_ring(begin, end);
  const bool is_in_degrees =
      crs_.kind != SourceCrs::Kind::projected && crs_.kind != SourceCrs::Kind::web_mercator;
  if (is_in_degrees) lay_cuts_on_seam(ring_);
  if (grid_ != nullptr) return append_on_grid(feature);
  Rings& rings = feature.rings;
  project_ring();

  const Extent extent = extent_of(ring_);
  west_ = std::min(west_, extent.min_x);
  east_ = std::max(east_, extent.max_x);
  if (extent.min_x >= kGridMin && extent.max_x <= kGridMax && extent.min_y >= kGridMin &&
      extent.max_y <= kGridMax) {
    append_snapped(ring_, rings);
    turns_.resize(rings.size(), 0);
    return;
  }
  for (const double shift : {0.0, -kTurn, kTurn}) {
    if (extent.min_x + shift < kGridMax && extent.max_x + shift > kGridMin) {
      append_clipped(shift, rings);
      turns_.resize(rings.size(), shift);
    }
  }
}

/// Makes a part of the rings of each turn around the world, from ring `first` on, if these are
/// longer than the world: by even-odd, what they cover twice would be left out. The last part is
/// not ended yet.
void RingReader::separate_turns(std::size_t first, FeatureRings& feature) const {
  if (!is_longer_than_world()) return;
  Rings separate;
  for (std::size_t i = 0; i < first; ++i) separate.add(feature.rings[i]);
  for (const double turn : {0.0, -kTurn, kTurn}) {
    const std::size_t begin = separate.size();
    const bool is_more =
        begin > first && (feature.part_ends.empty() || feature.part_ends.back() < begin);
    if (is_more) feature.part_ends.push_back(static_cast<std::uint32_t>(begin));
    for (std::size_t i = first; i < feature.rings.size(); ++i) {
      if (turns_[i] == turn) separate.add(feature.rings[i]);
    }
  }
  feature.rings = std::move(separate);
}

void RingReader::unwrap_ring(std::size_t begin, std::size_t end) {
  on_plane_.clear();
  for (std::size_t i = begin; i < end; ++i) on_plane_.push_back({source_x_[i], source_y_[i]});
  const PointMap to_lonlat = [this](std::vector<double>& x, std::vector<double>& y) {
    return map_to_lonlat(x, y);
  };
  unwrap_longitudes(ring_, on_plane_, {to_lonlat, crs_.metres_per_unit});
}

void RingReader::project_ring() {
  if (crs_.kind == SourceCrs::Kind::web_mercator) {
    for (Position& p : ring_) {
      const GridPosition cell = grid_from_metres(p.x, p.y);
      p = {cell.x, cell.y};
    }
    return;
  }
  clip_latitude();
  for (Position& p : ring_) {
    const GridPosition cell = grid_from_lonlat({p.x, p.y});
    p = {cell.x, cell.y};
  }
}

// Before the projection, which maps the poles to infinity.
void RingReader::clip_latitude() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  clip_ring(ring_, {-kInfinity, -kMaxLatitude, kInfinity, kMaxLatitude}, scratch_);
}

void RingReader::append_clipped(double shift, Rings& rings) {
  clipped_.clear();
  for (const Position p : ring_) clipped_.push_back({p.x + shift, p.y});
  clip_ring(clipped_, kWorld, scratch_);
  append_snapped(clipped_, rings);
}

}  // namespace trapeze
