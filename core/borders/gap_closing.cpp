#include "core/borders/gap_closing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/borders/coverage_builder.h"
#include "core/grid/grid.h"
#include "core/grid/web_mercator.h"
#include "core/sweep/clean_rings.h"
#include "core/sweep/noding.h"
#include "core/sweep/segment_tree.h"

namespace trapeze {
namespace {

using Place = std::uint32_t;  // number, in sweep order, of a point that is a vertex

double squared_length(double x, double y) {
  return x * x + y * y;
}

double squared_distance(Point a, Point b) {
  return squared_length(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y);
}

/// The foot of the perpendicular from a point to a segment: its position as a fraction of the
/// segment, and the length of the perpendicular.
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

/// Segments sorted by place, with a tree over them, each with its original index.
class PlacedSegments {
 public:
  explicit PlacedSegments(const std::vector<Segment>& segments)
      : order_(order_by_place(segments)), ordered_(in_order(segments)), tree_(ordered_) {}

  /// Calls visit(number) for every segment whose box intersects `box`.
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
    is_fixed_.assign(points_.size(), false);
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

  /// Fixes the vertices of these features in place, including those shared with others.
  void fix(std::span<const Rings* const> features) {
    for (const Rings* rings : features) {
      for (const Point p : rings->points) {
        const Place place = find(p);
        if (place < points_.size() && points_[place] == p) is_fixed_[place] = true;
      }
    }
  }
  bool is_fixed(Place place) const { return is_fixed_[place]; }

  /// Moves one to the other; false if neither may move.
  bool join(Place a, Place b) {
    const bool a_must_stay = is_fixed_[a] || has_guests_[a];
    const bool b_must_stay = is_fixed_[b] || has_guests_[b];
    if (is_moved(a) || is_moved(b) || (a_must_stay && b_must_stay)) return false;
    // The one with more features stays; for equal numbers, the first one.
    const bool b_stays = b_must_stay || (!a_must_stay && owners_[b].size() > owners_[a].size());
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
  std::vector<bool> is_fixed_;
};

/// Counts examined and found items, which also take memory, and reports when that amounts to a few
/// seconds' work: if the distance is large compared with that between vertices, each is near to
/// all.
class WorkLimit {
 public:
  explicit WorkLimit(std::size_t places) : left_(std::max(kLeast, kEach * places)) {}

  void look() { spend(1); }
  void find() { spend(16); }
  bool is_reached() const { return left_ == 0; }

 private:
  static constexpr std::size_t kLeast = std::size_t{1} << 26;
  static constexpr std::size_t kEach = 512;

  void spend(std::size_t work) { left_ -= std::min(left_, work); }

  std::size_t left_;
};

/// Two vertices of different features, near each other.
struct Pair {
  double squared_distance;
  Place a;
  Place b;
  auto operator<=>(const Pair&) const = default;
};

std::vector<Pair> near_pairs(const Places& places, double metres, WorkLimit& limit) {
  std::vector<Segment> points;
  points.reserve(places.size());
  for (Place a = 0; a < places.size(); ++a) points.emplace_back(places.point(a), places.point(a));
  const PlacedSegments placed(points);
  std::vector<Pair> pairs;
  for (Place a = 0; a < places.size() && !limit.is_reached(); ++a) {
    const Point p = places.point(a);
    const double reach = cells_from_ground(metres, p.y);
    placed.query(around(p, reach), [&](Place b) {
      limit.look();
      if (b <= a || limit.is_reached() || !places.are_strangers(a, b)) return;
      const double squared = squared_distance(p, places.point(b));
      if (squared > reach * reach) return;
      limit.find();
      pairs.push_back({squared, a, b});
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
                             double metres, WorkLimit& limit) {
  std::vector<Segment> segments;
  segments.reserve(borders.size());
  for (const Border& border : borders) {
    segments.emplace_back(places.point(border.from), places.point(border.to));
  }
  const PlacedSegments placed(segments);
  std::vector<Stop> stops;
  for (Place place = 0; place < places.size() && !limit.is_reached(); ++place) {
    if (places.is_moved(place)) continue;
    const Point p = places.point(place);
    const double reach = cells_from_ground(metres, p.y);
    placed.query(around(p, reach), [&](std::uint32_t i) {
      limit.look();
      if (limit.is_reached()) return;
      const Border& border = borders[i];
      if (border.from == border.to || places.is_owned_by(place, border.feature)) return;
      if (places.is_fixed(border.from) && places.is_fixed(border.to)) return;
      const Foot foot = foot_of(p, segments[i].first, segments[i].second);
      if (foot.along <= 0 || foot.along >= 1 || foot.squared_distance > reach * reach) return;
      limit.find();
      stops.push_back({i, foot.along, place});
    });
  }
  std::sort(stops.begin(), stops.end());
  return stops;
}

/// Precondition: the borders are in the order of the features' points.
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

/// The result of bringing features together, and its cost.
struct Attempt {
  std::size_t moved = 0;
  std::size_t led = 0;
  bool is_too_much = false;
};

/// The others do not take part, but keep everything that they share with features that do.
Attempt bring_together(std::span<Rings* const> features, std::span<const Rings* const> others,
                       double metres) {
  Attempt attempt;
  Places places(features);
  places.fix(others);
  WorkLimit limit(places.size());
  for (const Pair& pair : near_pairs(places, metres, limit)) {
    if (places.are_strangers(pair.a, pair.b)) attempt.moved += places.join(pair.a, pair.b);
  }
  const std::vector<Border> borders = borders_of(features, places);
  const std::vector<Stop> stops = find_stops(borders, places, metres, limit);
  attempt.led = stops.size();
  attempt.is_too_much = limit.is_reached();
  if (!attempt.is_too_much) rebuild(features, borders, stops, places);
  return attempt;
}

double length_of(const Rings& rings) {
  double length = 0;
  for (const auto& [a, b] : segments_of(rings)) length += std::sqrt(squared_distance(a, b));
  return length;
}

/// A feature as it was drawn, and the limits of its change.
struct Drawn {
  Rings rings;
  double length = 0;  // of its boundary, in cells
  double change = 0;  // tolerated change of its area, in cells squared
};

std::vector<Drawn> drawn_features(std::span<Rings* const> features, double metres) {
  std::vector<Drawn> drawn;
  drawn.reserve(features.size());
  for (const Rings* rings : features) {
    Box box;
    for (const Point p : rings->points) box.include(p);
    const double y = (static_cast<double>(box.min_y) + box.max_y) / 2;
    const double length = length_of(*rings);
    drawn.push_back({*rings, length, rings->empty() ? 0 : length * cells_from_ground(metres, y)});
  }
  return drawn;
}

/// The features taking part that gap closing has enlarged, shrunk or made to overlap by more than
/// is tolerated; of two that overlap, the smaller one if it takes part. In ascending order.
std::vector<std::uint32_t> spoilt_features(const std::vector<Drawn>& drawn,
                                           const std::vector<bool>& takes_part,
                                           const Overlay& before, const Overlay& after) {
  std::vector<std::uint32_t> spoilt;
  for (std::uint32_t i = 0; i < drawn.size(); ++i) {
    if (takes_part[i] && std::abs(after.areas[i] - before.areas[i]) > drawn[i].change) {
      spoilt.push_back(i);
    }
  }
  const auto place = [](const Overlap& overlap) { return std::pair(overlap.lower, overlap.upper); };
  for (const Overlap& overlap : after.overlaps) {
    const auto [a, b] = place(overlap);
    const auto known = std::ranges::lower_bound(before.overlaps, place(overlap), {}, place);
    const bool is_known = known != before.overlaps.end() && place(*known) == place(overlap);
    const double strip = std::min(drawn[a].length, drawn[b].length);  // one cell wide
    if (overlap.area <= (is_known ? known->area : 0) + strip) continue;
    const bool takes_a = takes_part[a] && (!takes_part[b] || before.areas[a] < before.areas[b]);
    if (takes_a || takes_part[b]) spoilt.push_back(takes_a ? a : b);
  }
  std::sort(spoilt.begin(), spoilt.end());
  spoilt.erase(std::unique(spoilt.begin(), spoilt.end()), spoilt.end());
  return spoilt;
}

Overlay overlay_of(std::span<Rings* const> features) {
  return overlay(std::vector<const Rings*>(features.begin(), features.end()));
}

/// Closes gaps in rounds: spoilt features do not take part in the next one.
class GapRounds {
 public:
  GapRounds(std::span<Rings* const> features, double metres)
      : features_(features),
        metres_(metres),
        drawn_(drawn_features(features, metres)),
        takes_part_(features.size(), true) {
    done_.drawn.resize(features.size());
  }

  GapClosing close() {
    before_ = overlay_of(features_);
    if (!before_.failure.empty()) return give_up(before_.failure);
    leave_out_narrow();
    // Each round leaves out features next to those left out before, or none.
    constexpr int kMostRounds = 12;
    for (int round = 0; round < kMostRounds; ++round) {
      const Attempt attempt =
          bring_together(taking_part<Rings*>(true), taking_part<const Rings*>(false), metres_);
      if (attempt.is_too_much) {
        return give_up("too many vertices are that near to each other");
      }
      if (attempt.moved + attempt.led == 0) return std::move(done_);
      const Overlay after = overlay_of(features_);
      if (!after.failure.empty()) return give_up(after.failure);
      const auto spoilt = spoilt_features(drawn_, takes_part_, before_, after);
      if (spoilt.empty()) return finish(attempt);
      restore();
      for (const std::uint32_t i : spoilt) takes_part_[i] = false;
      done_.kept.insert(done_.kept.end(), spoilt.begin(), spoilt.end());
      std::sort(done_.kept.begin(), done_.kept.end());
    }
    return give_up("they would overlap");
  }

 private:
  void leave_out_narrow() {
    for (std::uint32_t i = 0; i < features_.size(); ++i) {
      if (before_.areas[i] >= drawn_[i].change) continue;
      takes_part_[i] = false;
      done_.narrow.push_back(i);
    }
  }

  /// The features that take part, or those that do not.
  template <class Pointer>
  std::vector<Pointer> taking_part(bool they_do) const {
    std::vector<Pointer> features;
    for (std::size_t i = 0; i < features_.size(); ++i) {
      if (takes_part_[i] == they_do) features.push_back(features_[i]);
    }
    return features;
  }

  void restore() {
    for (std::size_t i = 0; i < features_.size(); ++i) *features_[i] = drawn_[i].rings;
  }

  GapClosing give_up(const std::string& reason) {
    restore();
    GapClosing nothing;
    nothing.drawn.resize(features_.size());
    nothing.failure = reason;
    return nothing;
  }

  GapClosing finish(const Attempt& attempt) {
    done_.moved = attempt.moved;
    done_.led = attempt.led;
    for (std::size_t i = 0; i < features_.size(); ++i) {
      if (*features_[i] != drawn_[i].rings) done_.drawn[i] = std::move(drawn_[i].rings);
    }
    return std::move(done_);
  }

  std::span<Rings* const> features_;
  const double metres_;
  std::vector<Drawn> drawn_;
  std::vector<bool> takes_part_;
  Overlay before_;
  GapClosing done_;
};

}  // namespace

GapClosing close_gaps(std::span<Rings* const> features, double metres) {
  return GapRounds(features, metres).close();
}

}  // namespace trapeze
