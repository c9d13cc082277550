#include "core/borders/gap_closing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/web_mercator.h"
#include "core/sweep/clean_rings.h"
#include "core/sweep/segment_tree.h"

namespace trapeze {
namespace {

using Place = std::uint32_t;  // a point that is a vertex, by its number in sweep order

double squared_length(double x, double y) {
  return x * x + y * y;
}

double squared_distance(Point a, Point b) {
  return squared_length(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y);
}

/// The foot of the perpendicular from a point to a segment, as a share of the segment, and its
/// length.
struct Foot {
  double along = 0;
  double squared_distance = 0;
};
Foot foot_of(Point p, Point a, Point b) {
  const double dx = static_cast<double>(b.x) - a.x;
  const double dy = static_cast<double>(b.y) - a.y;
  const double px = static_cast<double>(p.x) - a.x;
  const double py = static_cast<double>(p.y) - a.y;
  const double along = (px * dx + py * dy) / squared_length(dx, dy);
  return {along, squared_length(px - along * dx, py - along * dy)};
}

std::int32_t on_grid(double coordinate) {
  return static_cast<std::int32_t>(
      std::clamp<double>(coordinate, std::int32_t{kGridMin}, std::int32_t{kGridMax}));
}

Box around(Point p, double reach) {
  return {on_grid(std::floor(p.x - reach)), on_grid(std::floor(p.y - reach)),
          on_grid(std::ceil(p.x + reach)), on_grid(std::ceil(p.y + reach))};
}

/// Segments sorted by place, with a tree over them, each with its index as given.
class PlacedSegments {
 public:
  explicit PlacedSegments(const std::vector<Segment>& segments)
      : order_(order_by_place(segments)), ordered_(in_order(segments)), tree_(ordered_) {}

  /// Calls visit(number) for every segment whose box meets `box`.
  template <class Visit>
  void query(const Box& box, const Visit& visit) const {
    tree_.query(box, [&](std::size_t leaf) {
      for (std::size_t i = SegmentTree::leaf_begin(leaf); i < tree_.leaf_end(leaf); ++i) {
        if (box_of(ordered_[i]).intersects(box)) visit(order_[i].second);
      }
    });
  }

 private:
  std::vector<Segment> in_order(const std::vector<Segment>& segments) const {
    std::vector<Segment> ordered;
    ordered.reserve(segments.size());
    for (const auto& [place, number] : order_) ordered.push_back(segments[number]);
    return ordered;
  }

  std::vector<std::pair<std::uint32_t, std::uint32_t>> order_;
  std::vector<Segment> ordered_;
  SegmentTree tree_;
};

/// The vertices of all features: the place of each, its features, and the place to which it moves.
class Places {
 public:
  explicit Places(std::span<Rings* const> features) {
    for (const Rings* rings : features) {
      points_.insert(points_.end(), rings->points.begin(), rings->points.end());
    }
    std::sort(points_.begin(), points_.end(), is_above);
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    owners_.resize(points_.size());
    target_.resize(points_.size());
    has_guests_.assign(points_.size(), false);
    for (Place place = 0; place < points_.size(); ++place) target_[place] = place;
    for (std::uint32_t feature = 0; feature < features.size(); ++feature) {
      for (const Point p : features[feature]->points) add_owner(find(p), feature);
    }
  }

  std::size_t size() const { return points_.size(); }
  Point point(Place place) const { return points_[place]; }
  Place find(Point p) const {
    return static_cast<Place>(std::lower_bound(points_.begin(), points_.end(), p, is_above) -
                              points_.begin());
  }
  Place target(Place place) const { return target_[place]; }
  bool is_moved(Place place) const { return target_[place] != place; }
  bool is_owned_by(Place place, std::uint32_t feature) const {
    return std::binary_search(owners_[place].begin(), owners_[place].end(), feature);
  }

  /// Whether each has a feature that the other does not have.
  bool are_strangers(Place a, Place b) const {
    return !std::ranges::includes(owners_[a], owners_[b]) &&
           !std::ranges::includes(owners_[b], owners_[a]);
  }

  /// Moves one to the other; false if neither may move.
  bool join(Place a, Place b) {
    if (is_moved(a) || is_moved(b) || (has_guests_[a] && has_guests_[b])) return false;
    // The one with more features stays, or else the first one.
    const bool b_stays =
        has_guests_[b] || (!has_guests_[a] && owners_[b].size() > owners_[a].size());
    const Place guest = b_stays ? a : b;
    const Place host = b_stays ? b : a;
    target_[guest] = host;
    has_guests_[host] = true;
    for (const std::uint32_t owner : owners_[guest]) add_owner(host, owner);
    return true;
  }

 private:
  void add_owner(Place place, std::uint32_t feature) {
    std::vector<std::uint32_t>& owners = owners_[place];
    const auto at = std::lower_bound(owners.begin(), owners.end(), feature);
    if (at == owners.end() || *at != feature) owners.insert(at, feature);
  }

  std::vector<Point> points_;
  std::vector<std::vector<std::uint32_t>> owners_;  // in ascending order
  std::vector<Place> target_;
  std::vector<bool> has_guests_;
};

/// Two vertices of different features, near each other.
struct Pair {
  double squared_distance;
  Place a;
  Place b;
  auto operator<=>(const Pair&) const = default;
};

std::vector<Pair> near_pairs(const Places& places, double metres) {
  std::vector<Segment> points;
  points.reserve(places.size());
  for (Place a = 0; a < places.size(); ++a) points.emplace_back(places.point(a), places.point(a));
  const PlacedSegments placed(points);
  std::vector<Pair> pairs;
  for (Place a = 0; a < places.size(); ++a) {
    const Point p = places.point(a);
    const double reach = cells_from_ground(metres, p.y);
    placed.query(around(p, reach), [&](Place b) {
      if (b <= a || !places.are_strangers(a, b)) return;
      const double squared = squared_distance(p, places.point(b));
      if (squared <= reach * reach) pairs.push_back({squared, a, b});
    });
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// An edge of a feature, between the places to which its ends have moved.
struct Border {
  std::uint32_t feature;
  std::uint32_t index;  // of its first point in the rings of the feature
  Place from;
  Place to;
};

std::vector<Border> borders_of(std::span<Rings* const> features, const Places& places) {
  std::vector<Border> borders;
  for (std::uint32_t feature = 0; feature < features.size(); ++feature) {
    const Rings& rings = *features[feature];
    std::uint32_t begin = 0;
    for (const std::uint32_t end : rings.ends) {
      for (std::uint32_t i = begin; i < end; ++i) {
        const Point next = rings.points[i + 1 < end ? i + 1 : begin];
        borders.push_back({feature, i, places.target(places.find(rings.points[i])),
                           places.target(places.find(next))});
      }
      begin = end;
    }
  }
  return borders;
}

/// A vertex through which an edge is to be routed.
struct Stop {
  std::uint32_t border;
  double along;
  Place place;
  auto operator<=>(const Stop&) const = default;
};

std::vector<Stop> find_stops(const std::vector<Border>& borders, const Places& places,
                             double metres) {
  std::vector<Segment> segments;
  segments.reserve(borders.size());
  for (const Border& border : borders) {
    segments.emplace_back(places.point(border.from), places.point(border.to));
  }
  const PlacedSegments placed(segments);
  std::vector<Stop> stops;
  for (Place place = 0; place < places.size(); ++place) {
    if (places.is_moved(place)) continue;
    const Point p = places.point(place);
    const double reach = cells_from_ground(metres, p.y);
    placed.query(around(p, reach), [&](std::uint32_t i) {
      const Border& border = borders[i];
      if (border.from == border.to || places.is_owned_by(place, border.feature)) return;
      const Foot foot = foot_of(p, segments[i].first, segments[i].second);
      if (foot.along <= 0 || foot.along >= 1 || foot.squared_distance > reach * reach) return;
      stops.push_back({i, foot.along, place});
    });
  }
  std::sort(stops.begin(), stops.end());
  return stops;
}

/// The borders are in the order of the features' points.
void rebuild(std::span<Rings* const> features, const std::vector<Border>& borders,
             const std::vector<Stop>& stops, const Places& places) {
  auto stop = stops.begin();
  std::size_t i = 0;
  for (std::uint32_t feature = 0; feature < features.size(); ++feature) {
    Rings& rings = *features[feature];
    Rings built;
    for (const std::uint32_t end : rings.ends) {
      for (; i < borders.size() && borders[i].feature == feature && borders[i].index < end; ++i) {
        built.points.push_back(places.point(borders[i].from));
        for (; stop != stops.end() && stop->border == i; ++stop) {
          built.points.push_back(places.point(stop->place));
        }
      }
      built.close_ring();
    }
    clean_rings(built);
    rings = std::move(built);
  }
}

}  // namespace

GapClosing close_gaps(std::span<Rings* const> features, double metres) {
  GapClosing done;
  Places places(features);
  for (const Pair& pair : near_pairs(places, metres)) {
    if (places.are_strangers(pair.a, pair.b)) done.moved += places.join(pair.a, pair.b);
  }
  const std::vector<Border> borders = borders_of(features, places);
  const std::vector<Stop> stops = find_stops(borders, places, metres);
  done.led = stops.size();
  rebuild(features, borders, stops, places);
  return done;
}

}  // namespace trapeze
