#include "core/io/source/unwrap_longitudes.h"

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace trapeze {
namespace {

constexpr double kTurn = 360;

// An edge is followed if it is longer on the plane, or if its ends are farther apart. No plane in
// use shows three quarters of a parallel within this length, except near a pole.
constexpr double kLongMetres = 1e6;
constexpr double kFarDegrees = 90;
// Ends this near to each other are on two sides of a cut through the plane.
constexpr double kShortMetres = 0.01;

// The edges of a ring are cut in at most so many places in total, plus so many per vertex. Once
// around the world takes 40 cuts, and near a pole some 30 more. Far from the area where a system is
// used, its longitudes may come in no order.
constexpr std::size_t kMostCuts = 2000;
constexpr std::size_t kMostCutsOfVertex = 2;
// Nearer to a pole, longitudes do not determine where a point is.
constexpr double kPoleLatitude = 89.9999;

struct Vertex {
  Position on_plane;
  Position place;  // degrees
};

// The shorter way from one to the other.
double shorter_way(const Vertex& from, const Vertex& to) {
  double step = to.place.x - from.place.x;
  if (step > kTurn / 2) step -= kTurn;
  if (step < -kTurn / 2) step += kTurn;
  return step;
}

// How far east the edge leads on the plane; none if that cannot be determined with so many cuts,
// which are deducted.
std::optional<double> way_on_plane(const Vertex& from, const Vertex& to, const SourcePlane& plane,
                                   std::size_t& cuts) {
  const double step = shorter_way(from, to);
  const double metres = plane.metres_per_unit * std::hypot(to.on_plane.x - from.on_plane.x,
                                                           to.on_plane.y - from.on_plane.y);
  if (std::abs(step) <= kFarDegrees && metres <= kLongMetres) return step;
  if (metres <= kShortMetres) return step;
  if (cuts == 0) return std::nullopt;
  --cuts;
  const Position middle = {(from.on_plane.x + to.on_plane.x) / 2,
                           (from.on_plane.y + to.on_plane.y) / 2};
  std::vector<double> x = {middle.x};
  std::vector<double> y = {middle.y};
  if (!plane.to_lonlat(x, y) || std::abs(y[0]) > kPoleLatitude) return std::nullopt;
  const Vertex between = {middle, {x[0], y[0]}};
  const std::optional<double> before = way_on_plane(from, between, plane, cuts);
  if (!before) return std::nullopt;
  const std::optional<double> after = way_on_plane(between, to, plane, cuts);
  if (!after) return std::nullopt;
  return *before + *after;
}

// The turns of the world to be added to the longitude of `to` so that it differs from that of
// `from` as the edge leads.
double turns_of_edge(const Vertex& from, const Vertex& to, const SourcePlane& plane,
                     std::size_t& cuts) {
  const double way = way_on_plane(from, to, plane, cuts).value_or(shorter_way(from, to));
  return kTurn * std::nearbyint((way - (to.place.x - from.place.x)) / kTurn);
}

}  // namespace

void unwrap_longitudes(PositionRing& ring, const PositionRing& on_plane, const SourcePlane& plane) {
  if (ring.empty()) return;
  std::size_t cuts = kMostCuts + kMostCutsOfVertex * ring.size();
  double turns = 0;
  double latitude_sum = 0;
  const Vertex first = {on_plane.front(), ring.front()};
  Vertex previous = first;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vertex vertex = {on_plane[i], ring[i]};
    turns += turns_of_edge(previous, vertex, plane, cuts);
    ring[i].x += turns;
    latitude_sum += vertex.place.y;
    previous = vertex;
  }
  turns += turns_of_edge(previous, first, plane, cuts);
  if (turns == 0) return;
  const double around = first.place.x + std::copysign(kTurn, turns);
  const double pole = latitude_sum < 0 ? -90 : 90;
  ring.insert(ring.end(), {{around, first.place.y}, {around, pole}, {first.place.x, pole}});
}

}  // namespace trapeze
