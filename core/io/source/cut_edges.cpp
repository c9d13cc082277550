#include "core/io/source/cut_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

namespace trapeze {
namespace {

constexpr int kMostHalvings = 20;
constexpr double kSeen = 0.75;  // fraction of the deviation that is visible at the examined points
constexpr std::array<double, 3> kParts = {1.0 / 3, 0.5, 2.0 / 3};
constexpr double kMetresPerDegree = 111'320;  // of latitude, and of longitude at the equator

bool comes_first(Position a, Position b) {
  return std::tie(a.x, a.y) < std::tie(b.x, b.y);
}

Position between(Position a, Position b, double part) {
  if (part == 0.5) return {(a.x + b.x) / 2, (a.y + b.y) / 2};
  return {a.x + (b.x - a.x) * part, a.y + (b.y - a.y) * part};
}

bool map_points(const PositionRing& from, const PointMap& map, PositionRing& to) {
  std::vector<double> x(from.size());
  std::vector<double> y(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    x[i] = from[i].x;
    y[i] = from[i].y;
  }
  if (!map(x, y)) return false;
  to.resize(from.size());
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = {x[i], y[i]};
  return true;
}

}  // namespace

double distance_on_plane(Position point, Position from, Position to) {
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double squared = dx * dx + dy * dy;
  double part = 0;
  if (squared > 0) part = ((point.x - from.x) * dx + (point.y - from.y) * dy) / squared;
  part = std::clamp(part, 0.0, 1.0);
  return std::hypot(point.x - from.x - part * dx, point.y - from.y - part * dy);
}

double metres_of_degrees(Position point, Position from, Position to) {
  const double least_longitude = std::min({point.x, from.x, to.x});
  const double most_longitude = std::max({point.x, from.x, to.x});
  if (most_longitude - least_longitude > 180) return 0;
  const double latitude = std::min({std::abs(point.y), std::abs(from.y), std::abs(to.y)});
  const double shrink = std::cos(latitude * std::numbers::pi / 180);
  const auto in_metres = [shrink](Position p) {
    return Position{p.x * shrink * kMetresPerDegree, p.y * kMetresPerDegree};
  };
  return distance_on_plane(in_metres(point), in_metres(from), in_metres(to));
}

bool cut_edges(MappedRing& ring, const PointMap& map, DistanceFromChord distance, double most) {
  if (!map_points(ring.before, map, ring.after)) return false;
  std::vector<char> is_open(ring.before.size(), 1);  // the edge from each point to the next
  MappedRing next;
  PositionRing looked_at;
  PositionRing seen;
  for (int halvings = 0; halvings < kMostHalvings; ++halvings) {
    const std::size_t count = ring.before.size();
    const auto following = [count](std::size_t i) { return i + 1 == count ? 0 : i + 1; };
    looked_at.clear();
    for (std::size_t i = 0; i < count; ++i) {
      if (is_open[i] == 0) continue;
      Position a = ring.before[i];
      Position b = ring.before[following(i)];
      if (comes_first(b, a)) std::swap(a, b);
      for (const double part : kParts) looked_at.push_back(between(a, b, part));
    }
    if (looked_at.empty()) break;
    if (!map_points(looked_at, map, seen)) return false;
    next.before.clear();
    next.after.clear();
    std::vector<char> next_is_open;
    std::size_t k = 0;
    for (std::size_t i = 0; i < count; ++i) {
      next.before.push_back(ring.before[i]);
      next.after.push_back(ring.after[i]);
      if (is_open[i] == 0) {
        next_is_open.push_back(0);
        continue;
      }
      double off = 0;
      for (std::size_t part = 0; part < kParts.size(); ++part) {
        off = std::max(off, distance(seen[k + part], ring.after[i], ring.after[following(i)]));
      }
      const bool is_cut = off > kSeen * most;
      next_is_open.push_back(is_cut ? 1 : 0);
      if (is_cut) {
        next.before.push_back(looked_at[k + 1]);
        next.after.push_back(seen[k + 1]);
        next_is_open.push_back(1);
      }
      k += kParts.size();
    }
    std::swap(ring, next);
    is_open.swap(next_is_open);
  }
  return true;
}

}  // namespace trapeze
