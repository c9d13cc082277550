#include "core/mesh/exaggeration.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>

#include "core/grid/box_margin.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kNone = BoundaryMap::kNone;
constexpr std::uint32_t kLong = kNone - 1;  // instead of the number of a loop
constexpr std::uint32_t kSeen = kNone - 1;  // instead of that of a moved side, until all are known

// Instead of the length of a ray: not known at all, or known only to be long enough.
constexpr float kUnknown = -1;
constexpr float kWide = -2;
constexpr double kRounding = 1e-6;  // at least the rounding error of stored numbers

// Lengths in pixels.
constexpr double kLeastStep = 1;    // between samples, unless there would be more than kMostSteps
constexpr double kOffEnds = 0.05;   // values for an end of an edge are computed slightly beside it
constexpr double kTouching = 0.02;  // walls this near to each other are one
constexpr double kLeastMove = 0.002;
constexpr double kLeastBend = 0.004;

// Of an edge: fewer than 32 bits can count, by more than those of a strip.
constexpr double kMostSteps = 2e9;

// A strip is always split after this many samples, so that the drawing of an edge does not depend
// on how much of it is known.
constexpr std::int32_t kStepsOfStrip = 4;

constexpr double kStraight = 0.052336;  // the sine of 3 degrees: smaller angles are not corners
constexpr double kMostOfTip = 1.5;      // times the distance by which the sides of a corner move

constexpr unsigned kStepsBetweenChecks = 1024;

// How the thickness of a face at some distance counts at a place: the radius of discs within the
// face must grow by this fraction of the distance, about as in a corner of 40 degrees. Otherwise,
// the thickness counts for less by this factor times the excess distance.
constexpr double kOpening = 0.36;
constexpr double kThinnerBeyond = 2;
// For reserves: the same factor, for the distance beyond the radius of the disc.
constexpr double kLessReserve = 0.5;

// The boundary met by a ray is the opposite side of a face if it is about parallel to the present
// side. It is not if it is about at right angles, as at the ends of strips that are not quite
// square. Cosines of the angle between them, of about 60 and 70 degrees.
constexpr double kOpposite = 0.49;
constexpr double kBeside = 0.34;

// In widths: the length of rays and the sizes of discs.
constexpr double kRay = 2.5;
constexpr std::array<double, 2> kMostRadii{0.5, 1};

// In widths: how far along the boundary thick places are searched.
constexpr double kWalk = 2;
constexpr double kMostOfLoop = 16;  // maximum length of a boundary that is examined as a whole

// Boundaries whose neighbourhood is gathered: the maximum number of their sides, and of the edges
// nearby.
constexpr int kMostSidesOfLoop = 64;
constexpr std::uint32_t kMostEdgesInLoop = 32;

// In radii: how far within the boundary a disc is searched if none fits directly beside an uneven
// boundary.
constexpr double kDepth = 1.5;

Vector turned(Vector way) {
  return {-way.y, way.x};
}

Point to_point(Vector v) {
  const auto cell = [](double x) {
    return static_cast<std::int32_t>(std::lround(std::clamp<double>(x, kGridMin, kGridMax)));
  };
  return {cell(v.x), cell(v.y)};
}

struct Touch {
  double radius = 0;
  double share = 0;  // of the way: where it is touched
};

/// The distance of a place on the map from the edges of the map.
double distance_to_frame(Vector at) {
  return std::max(0.0,
                  std::min({at.x - kGridMin, kGridMax - at.x, at.y - kGridMin, kGridMax - at.y}));
}

/// The same along a direction of length 1.
double way_to_frame(Vector at, Vector way) {
  const auto until = [](double from, double by) {
    if (by == 0) return std::numeric_limits<double>::infinity();
    return std::max(0.0, ((by > 0 ? kGridMax : kGridMin) - from) / by);
  };
  return std::min(until(at.x, way.x), until(at.y, way.y));
}

/// The width that a face counts as having, because of a disc at that distance.
double seen_from(double far, double own_radius, double radius) {
  const double opened = std::max(0.0, radius - own_radius) / kOpening;
  return 2 * radius - kThinnerBeyond * std::max(0.0, far - opened);
}

/// Of an angle, given by its sine and cosine.
bool is_straight(double sine, double cosine) {
  return cosine > 0 && std::abs(sine) < kStraight;
}

/// The smallest circle that touches a line through `from` there, on the side of the normal, and
/// reaches the segment that begins at `at`.
std::optional<Touch> circle_to(Vector from, Vector normal, Vector at, Vector way) {
  const Vector c = at - from;
  const double nc = dot(normal, c);
  const double nv = dot(normal, way);
  if (nc <= 0 && nc + nv <= 0) return std::nullopt;
  const double cc = dot(c, c);
  if (cc == 0) return Touch{0, 0};
  const double cv = dot(c, way);
  const double vv = dot(way, way);
  std::optional<Touch> least;
  const auto take = [&](double t) {
    const double ahead = nc + t * nv;
    if (!(t >= 0 && t <= 1) || ahead <= 1e-9) return;
    const double radius = (cc + 2 * t * cv + t * t * vv) / (2 * ahead);
    if (!least || radius < least->radius) least = Touch{radius, t};
  };
  take(0);
  take(1);
  // Where the radius no longer changes along the segment.
  const double a = vv * nv;
  const double half_b = vv * nc;
  const double e = 2 * cv * nc - nv * cc;
  if (std::abs(a) < 1e-12 * std::abs(half_b)) {
    if (half_b != 0) take(-e / (2 * half_b));
  } else {
    const double root = half_b * half_b - a * e;
    if (root >= 0) {
      take((-half_b + std::sqrt(root)) / a);
      take((-half_b - std::sqrt(root)) / a);
    }
  }
  return least;
}

/// Whether the segment that begins at `at` keeps farther away from (0, 0). False if the difference
/// is within rounding.
inline bool is_farther(Vector at, Vector way, double square_of_distance) {
  const double square = square_of_distance * (1 + kRounding);
  const double before = -dot(at, way);
  if (before <= 0) return dot(at, at) > square;
  const double all = dot(way, way);
  if (before >= all) return dot(at + way, at + way) > square;
  const double beside = cross(at, way);
  return beside * beside > square * all;
}

/// The fractions of the segment between which it is in the box; none if it is not.
std::optional<std::pair<double, double>> shares_in(const Box& box, Vector from, Vector way) {
  const Vector to = from + way;
  if (std::max(from.x, to.x) < box.min_x || std::min(from.x, to.x) > box.max_x ||
      to.y < box.min_y || from.y > box.max_y) {
    return std::nullopt;
  }
  double first = 0;
  double last = 1;
  const auto clip = [&](double at, double by, double min, double max) {
    if (by == 0) return at >= min && at <= max;
    const auto [enters, leaves] = std::minmax({(min - at) / by, (max - at) / by});
    first = std::max(first, enters);
    last = std::min(last, leaves);
    return first <= last;
  };
  if (!clip(from.x, way.x, box.min_x, box.max_x)) return std::nullopt;
  if (!clip(from.y, way.y, box.min_y, box.max_y)) return std::nullopt;
  return std::pair(first, last);
}

bool is_forward(std::uint32_t side) {
  return side % 2 == 0;
}

struct Ends {
  Point upper;
  Point lower;

  double x_at(double y) const { return EdgeLine(upper, lower).x_at(y); }
};

/// Appends, as holes, the area between two heights, east of both `wests` and west of both `easts`,
/// which all span these heights. Crossings are rounded to cells.
void append_cut(const std::array<Ends, 2>& wests, const std::array<Ends, 2>& easts,
                std::int32_t top, std::int32_t bottom, std::vector<Point>& vertices,
                std::vector<MeshEdge>& edges, std::vector<MeshTrapezoid>& trapezoids) {
  if (top >= bottom) return;
  std::array<std::int32_t, 6> heights{top, bottom, bottom, bottom, bottom, bottom};
  std::size_t count = 2;
  const auto add_crossing = [&](const Ends& one, const Ends& other) {
    const double above = one.x_at(top) - other.x_at(top);
    const double below = one.x_at(bottom) - other.x_at(bottom);
    if ((above > 0) == (below > 0) || above == below) return;
    const double y = top + (static_cast<double>(bottom) - top) * above / (above - below);
    heights[count++] = static_cast<std::int32_t>(std::lround(y));
  };
  add_crossing(wests[0], wests[1]);
  add_crossing(easts[0], easts[1]);
  add_crossing(wests[0], easts[1]);
  add_crossing(wests[1], easts[0]);
  std::ranges::sort(heights);
  for (std::size_t i = 1; i < heights.size(); ++i) {
    if (heights[i - 1] >= heights[i]) continue;
    const double middle = (static_cast<double>(heights[i - 1]) + heights[i]) / 2;
    const Ends& west = wests[wests[0].x_at(middle) < wests[1].x_at(middle) ? 1 : 0];
    const Ends& east = easts[easts[0].x_at(middle) > easts[1].x_at(middle) ? 1 : 0];
    if (west.x_at(middle) >= east.x_at(middle)) continue;
    const auto v = static_cast<std::uint32_t>(vertices.size());
    const auto e = static_cast<std::uint32_t>(edges.size());
    vertices.insert(vertices.end(),
                    {west.upper, west.lower, east.upper, east.lower,
                     Point{west.upper.x, heights[i - 1]}, Point{west.upper.x, heights[i]}});
    edges.insert(edges.end(), {{v, v + 1}, {v + 2, v + 3}});
    trapezoids.push_back({v + 4, v + 5, e + 1, e});
  }
}

}  // namespace

void Exaggeration::find(const Size& size, const Box& box, const Cancellation* cancellation) {
  width_ = size.width * size.pixel;
  pixel_ = size.pixel;
  box_ = box;
  around_box_ = with_margin(box_, kMostOfTip * width_);
  const Box around = with_margin(box, reach_of(size.width) * size.pixel);
  boundary_.find(around, std::max(size.width / 2, kLeastStep) * size.pixel);
  divide_edges(around);
  moved_.clear();
  moved_sides_.clear();
  tips_.clear();
  triangles_.clear();
  beside_others_.clear();
  CancellationCheck check(cancellation, kStepsBetweenChecks);
  const auto sides = static_cast<std::uint32_t>(2 * boundary_.edges().size());
  // Face by face, and by place, so that the data that one needs has just been read.
  number_of_moved_.assign(sides, kNone);
  const auto move_around = [&](std::uint32_t side) {
    for (; side != kNone && number_of_moved_[side] == kNone; side = boundary_.next(side)) {
      check();
      number_of_moved_[side] = kSeen;
      move_side(side);
    }
  };
  const Vector min{static_cast<double>(around.min_x), static_cast<double>(around.min_y)};
  const Vector max{static_cast<double>(around.max_x), static_cast<double>(around.max_y)};
  boundary_.for_each_near(min, max, [&](const BoundaryMap::Near& near) {
    move_around(2 * near.edge);
    move_around(2 * near.edge + 1);
  });
  number_moved_sides();
  for (std::uint32_t side = 0; side < sides; ++side) {
    if (const MovedSide* moved = find_moved(side)) append_strip(*moved);
  }
  for (std::uint32_t side = 0; side < sides; ++side) {
    const std::uint32_t next = boundary_.next(side);
    if (next != kNone) append_corner(side, next);
  }
  sort_triangles();
}

void Exaggeration::divide_edges(const Box& box) {
  rows_.clear();
  samples_.clear();
  places_.clear();
  discs_.clear();
  loop_of_side_.assign(2 * boundary_.edges().size(), kNone);
  place_of_side_.resize(2 * boundary_.edges().size());
  loops_.clear();
  loop_edges_.clear();
  loop_places_.clear();
  loop_order_.clear();
  const double step = std::max(width_ / 3, kLeastStep * pixel_);
  for (const BoundaryMap::Edge& edge : boundary_.edges()) {
    const Vector way = edge.way();
    const double along = length(way);
    Row row;
    row.normal = turned(way) * (1 / along);
    if (const auto shares = shares_in(box, edge.from(), way)) {
      row.steps = static_cast<std::int32_t>(std::min(std::ceil(along / step), kMostSteps));
      row.first = static_cast<std::int32_t>(std::floor(shares->first * row.steps));
      const auto last = static_cast<std::int32_t>(std::ceil(shares->second * row.steps));
      row.count = std::min(last, row.steps) - row.first + 1;
    }
    rows_.push_back(row);
  }
}

bool Exaggeration::has_sample(At at) const {
  const Row& row = rows_[at.side / 2];
  return row.steps > 0 && at.step >= row.first && at.step < row.first + row.count;
}

/// Valid until the next call.
Exaggeration::Sample& Exaggeration::sample(At at) {
  const Row& row = rows_[at.side / 2];
  if (row.sample == kNone) take_samples(at.side / 2);
  return samples_[row.sample + 2 * static_cast<std::uint32_t>(at.step - row.first) + at.side % 2];
}

Vector Exaggeration::place(At at) {
  const Row& row = rows_[at.side / 2];
  if (row.sample == kNone) take_samples(at.side / 2);
  return places_[row.sample / 2 + static_cast<std::uint32_t>(at.step - row.first)];
}

void Exaggeration::take_samples(std::uint32_t edge) {
  Row& row = rows_[edge];
  const BoundaryMap::Edge& line = boundary_.edges()[edge];
  row.sample = static_cast<std::uint32_t>(samples_.size());
  samples_.resize(samples_.size() + 2 * static_cast<std::size_t>(row.count));
  // At an end of the edge, slightly beside it.
  const double off = std::min(kOffEnds * pixel_ / length(line.way()), 0.125);
  for (std::int32_t i = row.first; i < row.first + row.count; ++i) {
    const double share = static_cast<double>(i) / row.steps;
    places_.push_back(line.from() + line.way() * std::clamp(share, off, 1 - off));
  }
}

Vector Exaggeration::inward(std::uint32_t side) const {
  const Vector normal = rows_[side / 2].normal;
  return is_forward(side) ? normal : normal * -1;
}

std::optional<Exaggeration::At> Exaggeration::step_on(At at) const {
  const bool is_last = at.step == (is_forward(at.side) ? rows_[at.side / 2].steps : 0);
  At next{at.side, at.step + (is_forward(at.side) ? 1 : -1)};
  if (is_last) {
    next.side = boundary_.next(at.side);
    if (next.side == kNone) return std::nullopt;
    next.step = is_forward(next.side) ? 0 : rows_[next.side / 2].steps;
  }
  if (!has_sample(next)) return std::nullopt;
  return next;
}

std::optional<Exaggeration::At> Exaggeration::step_back(At at) const {
  const bool is_first = at.step == (is_forward(at.side) ? 0 : rows_[at.side / 2].steps);
  At next{at.side, at.step - (is_forward(at.side) ? 1 : -1)};
  if (is_first) {
    next.side = boundary_.before(at.side);
    if (next.side == kNone) return std::nullopt;
    next.step = is_forward(next.side) ? rows_[next.side / 2].steps : 0;
  }
  if (!has_sample(next)) return std::nullopt;
  return next;
}

// ---- width of a face

/// Whether the distance straight into the face to its boundary is less than the width.
bool Exaggeration::is_narrow(At at) {
  if (const float known = sample(at).ray; known != kUnknown) return known >= 0 && known < width_;
  if (look_across(at, (1 + kRounding) / kRay)) return sample(at).ray < width_;
  sample(at).ray = kWide;
  return false;
}

/// The distance straight into the face to its boundary, at most kRay.
float Exaggeration::ray(At at) {
  if (const float known = sample(at).ray; known >= 0) return known;
  look_across(at, 1);
  return sample(at).ray;
}

/// Looks for the boundary up to that fraction of kRay. Returns whether it was found, or whether
/// that is all of kRay.
bool Exaggeration::look_across(At at, double share) {
  const Vector from = place(at);
  const Vector way = inward(at.side) * (kRay * width_);
  double least = share;
  double facing = 0;
  const auto look_at = [&](const BoundaryMap::Near& near) {
    if (near.edge == at.side / 2) return;
    const Vector along = near.way();
    const double turn = cross(way, along);
    if (turn == 0) return;
    const Vector c = near.from() - from;
    const double on_edge = cross(c, way);
    const double on_way = cross(c, along);
    const double most = std::abs(turn) * (1 + kRounding);
    if ((on_way > 0) != (turn > 0) || std::abs(on_way) > least * most) return;
    if (std::abs(on_edge) > most) return;
    const double there = on_edge / turn;
    if (there < 0 || there > 1) return;
    const double met = on_way / turn;
    if (met <= 0 || met > least) return;
    const double cosine = std::abs(turn) / (kRay * width_ * length(along));
    facing = met < least ? cosine : std::max(facing, cosine);
    least = met;
  };
  // Up to where the ray leaves the box of a loop, everything that it may meet is known.
  const std::uint32_t number = loop_of(at.side);
  bool is_known = false;
  if (number != kLong && loops_[number].edge_count > 0) {
    const Loop& loop = loops_[number];
    for (const BoundaryMap::Near& near : edges_in(loop)) look_at(near);
    const Vector end = from + way * least;
    is_known =
        end.x >= loop.min.x && end.x <= loop.max.x && end.y >= loop.min.y && end.y <= loop.max.y;
  }
  if (!is_known)
    boundary_.for_each_along(
        from, way, [&least] { return least; }, look_at);
  if (least == share && share < 1) return false;
  const double opposite = (facing - kBeside) / (kOpposite - kBeside);
  Sample& told = sample(at);
  told.facing = static_cast<float>(std::clamp(opposite, 0.0, 1.0));
  told.ray = static_cast<float>(least * kRay * width_);
  return true;
}

/// Half of the ray, or `most` if that is less.
double Exaggeration::half_ray(At at, double most) {
  if (2 * most <= width_ && !is_narrow(at)) return most;
  return std::min(most, ray(at) / 2.0);
}

/// A disc in the face, inwards from the place: the smaller or the larger one of kMostRadii. The
/// larger one, from which reserves follow, ends at the edges of the map: a face that was cut off
/// there may continue by very little.
Exaggeration::Disc Exaggeration::disc(At at, std::size_t size) {
  if (const std::uint32_t known = sample(at).discs[size]; known != kNone) return discs_[known];
  const double most = kMostRadii[size] * width_;
  const bool is_for_reserve = size == 1;
  Disc found;
  for (const double depth : {most, kDepth * most}) {
    double deep = half_ray(at, depth);
    if (is_for_reserve) deep = std::min(deep, way_to_frame(place(at), inward(at.side)) / 2);
    const Vector middle = place(at) + inward(at.side) * deep;
    double radius = clearance(middle, std::min(most, deep), loop_of(at.side));
    if (is_for_reserve) radius = std::min(radius, distance_to_frame(middle));
    if (radius > found.radius) found = {middle, radius};
    if (radius >= most || deep < depth) break;
  }
  sample(at).discs[size] = static_cast<std::uint32_t>(discs_.size());
  discs_.push_back(found);
  return found;
}

/// The distance, at most `most`, of a point within the face of the loop from the boundary.
double Exaggeration::clearance(Vector middle, double most, std::uint32_t loop) {
  double square = most * most;
  const auto look_at = [&](const BoundaryMap::Near& near) {
    const Vector way = near.way();
    const Vector c = middle - near.from();
    if (is_farther(near.from() - middle, way, square)) return;
    const double share = dot(way, c) / dot(way, way);
    const Vector nearest = near.from() + way * std::clamp(share, 0.0, 1.0) - middle;
    square = std::min(square, dot(nearest, nearest));
  };
  const auto radius = [&] { return std::min(most, std::sqrt(square)); };
  if (loop != kLong && loops_[loop].edge_count > 0) {
    const auto& [min, max] = std::pair(loops_[loop].min, loops_[loop].max);
    for (const BoundaryMap::Near& near : edges_in(loops_[loop])) look_at(near);
    const double to_side =
        std::min({middle.x - min.x, max.x - middle.x, middle.y - min.y, max.y - middle.y});
    if (radius() <= to_side) return radius();
  }
  // Near the point first: the distance often becomes so small there that little else has to be
  // examined.
  for (double looked_at = std::min(boundary_.cell() / 2, most);;) {
    const Vector corner{looked_at, looked_at};
    boundary_.for_each_near(middle - corner, middle + corner, look_at);
    if (radius() <= looked_at || looked_at >= most) return radius();
    looked_at = std::min(2 * looked_at, radius());
  }
}

/// Calls visit(at, place) for places along the boundary, in both directions, until one returns
/// true.
template <typename Visit>
void Exaggeration::walk_from(At at, double far, const Visit& visit) {
  const Vector from = place(at);
  if (visit(at, from)) return;
  for (const bool is_on : {true, false}) {
    double walked = 0;
    At last = at;
    Vector last_place = from;
    while (walked <= far) {
      const auto next = is_on ? step_on(last) : step_back(last);
      if (!next) break;
      if (next->side == at.side && next->step == at.step) return;  // went all the way round
      const Vector next_place = place(*next);
      walked += length(next_place - last_place);
      last = *next;
      last_place = next_place;
      if (visit(last, last_place)) return;
    }
  }
}

/// The width of the face that counts for growth, at a place where it is narrow straight across, and
/// at least that width: in a corner, the width that the corner reaches.
double Exaggeration::width_beside(At at) {
  const std::uint32_t loop = loop_of(at.side);
  if (loop != kLong && loops_[loop].is_short) {
    if (loops_[loop].count == 0) append_places(loops_[loop]);
    return widest_in(loops_[loop], at);
  }
  const Vector from = place(at);
  const double own = disc(at, 0).radius;
  double widest = ray(at);
  walk_from(at, kWalk * width_, [&](At other, Vector place_of_other) {
    const double far = length(place_of_other - from);
    if (seen_from(far, own, width_ / 2) <= widest) return false;
    if (seen_from(far, own, half_ray(other, width_ / 2)) <= widest) return false;
    widest = std::max(widest, seen_from(far, own, disc(other, 0).radius));
    return widest >= width_;
  });
  return widest;
}

/// The same, if the boundary is a loop.
double Exaggeration::widest_in(const Loop& loop, At at) {
  const std::span<LoopPlace> places = std::span(loop_places_).subspan(loop.first, loop.count);
  const std::int32_t steps = rows_[at.side / 2].steps;
  const std::uint32_t number =
      place_of_side_[at.side] - loop.first +
      static_cast<std::uint32_t>(is_forward(at.side) ? at.step : steps - at.step);
  LoopPlace& from = places[number];
  const auto is_within_walk = [&](std::uint32_t other) {
    const std::uint32_t last = other == 0 ? loop.count - 1 : other - 1;
    const std::uint32_t next = other + 1 == loop.count ? 0 : other + 1;
    const double on = places[last].along - from.along;
    const double back = from.along - places[next].along;
    const double far = kWalk * width_;
    return on + (on < 0 ? loop.around : 0) <= far || back + (back < 0 ? loop.around : 0) <= far;
  };
  double widest = ray(at);
  for (const std::uint32_t other : std::span(loop_order_).subspan(loop.first, loop.count)) {
    LoopPlace& place = places[other];
    if (2 * place.most <= widest || widest >= width_) break;
    if (other == number || (place.radius >= 0 && 2 * place.radius <= widest)) continue;
    const double far = length(place.place - from.place);
    if (seen_from(far, 0, place.most) <= widest) continue;
    if (2 * radius_of(place) <= widest) continue;
    const double seen = seen_from(far, radius_of(from), place.radius);
    if (seen > widest && is_within_walk(other)) widest = seen;
  }
  return widest;
}

double Exaggeration::radius_of(LoopPlace& place) {
  if (place.radius < 0) place.radius = disc(place.at, 0).radius;
  return place.radius;
}

/// An index into loops_, or kLong.
std::uint32_t Exaggeration::loop_of(std::uint32_t side) {
  return loop_of_side_[side] == kNone ? find_loop(side) : loop_of_side_[side];
}

/// Finds the boundary to which a side belongs, if it has few edges; otherwise marks all sides
/// followed so far as long.
std::uint32_t Exaggeration::find_loop(std::uint32_t side) {
  std::uint32_t end = side;
  int count = 0;
  do {
    end = boundary_.next(end);
    ++count;
  } while (end != kNone && end != side && count < kMostSidesOfLoop);
  if (end == side) {
    append_loop(side);
    return loop_of_side_[side];
  }
  std::uint32_t one = side;
  do {
    loop_of_side_[one] = kLong;
    one = boundary_.next(one);
  } while (one != end);
  return kLong;
}

void Exaggeration::append_loop(std::uint32_t side) {
  Loop loop;
  loop.side = side;
  loop.is_short = true;
  loop.min = boundary_.edges()[side / 2].from();
  loop.max = loop.min;
  std::uint32_t one = side;
  do {
    loop_of_side_[one] = static_cast<std::uint32_t>(loops_.size());
    const BoundaryMap::Edge& edge = boundary_.edges()[one / 2];
    const Row& row = rows_[one / 2];
    const bool is_whole = row.steps > 0 && row.first == 0 && row.count == row.steps + 1;
    loop.around += length(edge.way());
    loop.is_short = loop.is_short && is_whole;
    for (const Vector end : {to_vector(edge.upper), to_vector(edge.lower)}) {
      loop.min = {std::min(loop.min.x, end.x), std::min(loop.min.y, end.y)};
      loop.max = {std::max(loop.max.x, end.x), std::max(loop.max.y, end.y)};
    }
    one = boundary_.next(one);
  } while (one != side);
  loop.is_short = loop.is_short && loop.around <= kMostOfLoop * width_;
  append_edges(loop);
  loops_.push_back(loop);
}

void Exaggeration::append_edges(Loop& loop) {
  loop.first_edge = static_cast<std::uint32_t>(loop_edges_.size());
  boundary_.for_each_near(loop.min, loop.max, [&](const BoundaryMap::Near& near) {
    const Vector from = near.from();
    const Vector to = to_vector(near.lower);
    const bool is_beside = std::max(from.x, to.x) < loop.min.x ||
                           std::min(from.x, to.x) > loop.max.x || to.y < loop.min.y ||
                           from.y > loop.max.y;
    if (is_beside || loop.edge_count > kMostEdgesInLoop) return;
    const auto known = std::span(loop_edges_).subspan(loop.first_edge);
    if (std::ranges::find(known, near.edge, &BoundaryMap::Near::edge) != known.end()) return;
    loop_edges_.push_back(near);
    ++loop.edge_count;
  });
  if (loop.edge_count <= kMostEdgesInLoop) return;
  loop_edges_.resize(loop.first_edge);
  loop.edge_count = 0;
}

std::span<const BoundaryMap::Near> Exaggeration::edges_in(const Loop& loop) const {
  return std::span(loop_edges_).subspan(loop.first_edge, loop.edge_count);
}

void Exaggeration::append_places(Loop& loop) {
  loop.first = static_cast<std::uint32_t>(loop_places_.size());
  std::uint32_t one = loop.side;
  do {
    place_of_side_[one] = static_cast<std::uint32_t>(loop_places_.size());
    const std::int32_t steps = rows_[one / 2].steps;
    for (std::int32_t i = 0; i <= steps; ++i) {
      const At at{one, is_forward(one) ? i : steps - i};
      loop_places_.push_back({at, place(at), half_ray(at, width_ / 2)});
    }
    one = boundary_.next(one);
  } while (one != loop.side);
  const std::span<LoopPlace> places = std::span(loop_places_).subspan(loop.first);
  loop.count = static_cast<std::uint32_t>(places.size());
  for (std::uint32_t i = 0; i < loop.count; ++i) {
    loop_order_.push_back(i);
    if (i > 0)
      places[i].along = places[i - 1].along + length(places[i].place - places[i - 1].place);
  }
  loop.around = places.back().along + length(places.front().place - places.back().place);
  std::ranges::sort(std::span(loop_order_).subspan(loop.first), std::greater<>(),
                    [places](std::uint32_t i) { return places[i].most; });
}

/// The diameter of a disc in the face near the place, up to twice the width.
double Exaggeration::thickness(At at) {
  const Vector from = place(at);
  double thickest = 0;
  walk_from(at, kWalk * width_, [&](At other, Vector) {
    if (2 * half_ray(other, width_) <= thickest) return false;
    const Disc found = disc(other, 1);
    const double gap = std::max(0.0, length(found.middle - from) - found.radius);
    const double beyond = std::max(0.0, gap - found.radius);
    thickest = std::max(thickest, 2 * found.radius - kLessReserve * beyond);
    return thickest >= 2 * width_;
  });
  return thickest;
}

double Exaggeration::growth(At at) {
  if (const float known = sample(at).growth; known >= 0) return known;
  const bool is_still =
      boundary_.edges()[at.side / 2].is_cut || boundary_.face_of(at.side) == BoundaryMap::kNoFace;
  double by = is_still ? 0 : growth_across(at);
  // Beside a corner that is not quite square, a ray may end at the corner's other side; there the
  // value of the next place is used.
  const std::int32_t steps = rows_[at.side / 2].steps;
  const At inner{at.side, at.step == 0 ? 1 : at.step - 1};
  const bool is_end = at.step == 0 || at.step == steps;
  if (!is_still && is_end && is_narrow(at) && sample(at).facing < 1 && has_sample(inner)) {
    by = std::max(by, (1 - sample(at).facing) * growth_across(inner));
  }
  sample(at).growth = static_cast<float>(by);
  return sample(at).growth;
}

/// Half of what the width lacks straight across, at the place alone.
double Exaggeration::growth_across(At at) {
  if (!is_narrow(at) || sample(at).facing == 0) return 0;
  const double wide = width_beside(at);
  return sample(at).facing * std::max(0.0, (width_ - wide) / 2);
}

double Exaggeration::reserve(At at) {
  if (growth(at) > 0) return 0;
  if (const float known = sample(at).reserve; known >= 0) return known;
  const double more = (thickness(at) - width_) / 2;
  sample(at).reserve = static_cast<float>(std::max(0.0, more));
  return sample(at).reserve;
}

/// Interpolates between samples, for which `of` returns the values.
template <typename Of>
double Exaggeration::between_steps(std::uint32_t side, double share, const Of& of) {
  const Row& row = rows_[side / 2];
  const double at = share * row.steps;
  const auto step = static_cast<std::int32_t>(std::clamp<double>(std::floor(at), 0, row.steps));
  const auto of_step = [&](std::int32_t i) {
    const At place{side, std::clamp(i, 0, row.steps)};
    return has_sample(place) ? of(place) : 0.0;
  };
  const double between = at - step;
  if (between == 0) return of_step(step);
  return of_step(step) * (1 - between) + of_step(step + 1) * between;
}

/// Interpolated between samples; negative where there is a reserve.
double Exaggeration::signed_growth(std::uint32_t side, double share) {
  return between_steps(side, share, [this](At at) {
    const double by = growth(at);
    return by > 0 ? by : -reserve(at);
  });
}

/// The same, except for negative values. Reserves, which take long to find, matter only beside
/// something that grows.
double Exaggeration::positive_growth(std::uint32_t side, double share) {
  const double most = between_steps(side, share, [this](At at) { return growth(at); });
  return most > 0 ? std::max(0.0, signed_growth(side, share)) : 0;
}

// ---- limits of growth

/// How far a place may move along the normal, up to `by`.
double Exaggeration::limited(Vector from, Vector normal, double by,
                             const std::array<std::uint32_t, 3>& exempt) {
  if (by <= 0) return 0;
  double most = by;
  const double touching = kTouching * pixel_;
  const auto look_at = [&](const BoundaryMap::Near& near, double within) {
    const Vector way = near.way();
    const Vector c = near.from() - from;
    const double ahead = dot(normal, c);
    if (std::max(ahead, ahead + dot(normal, way)) < -touching) return;
    const double reach = within + touching;
    if (is_farther(c - normal * within, way, reach * reach)) return;
    // The side of the edge on which the place lies, unless it is so near that it is on both.
    const double turn = cross(c, way);
    const bool is_on_edge = turn * turn < touching * touching * dot(way, way) * (1 + kRounding);
    if (!is_on_edge && !near.has_face[turn > 0 ? 1 : 0]) return;
    if (std::ranges::find(exempt, near.edge) != exempt.end()) return;
    const BoundaryMap::Edge& edge = boundary_.edges()[near.edge];
    const double along = length(way);
    const double beside = cross(way, from - near.from()) / along;
    const auto limit = [&](std::uint32_t number, double radius, double at) {
      if (edge.faces[number] == BoundaryMap::kNoFace || radius >= most) return;
      const double gap = length(near.from() + way * at - from);
      if (gap - width_ / 2 >= most) return;
      const std::uint32_t side = 2 * near.edge + number;
      // Across a void, nothing is grown over.
      const bool is_beside_void = edge.faces[1 - number] == BoundaryMap::kNoFace;
      const double left =
          gap - (is_beside_void ? positive_growth(side, at) : signed_growth(side, at));
      most = std::min(most, std::max(radius, left));
    };
    const double nearest = dot(way, from - near.from()) / (along * along);
    const bool is_wall = std::abs(beside) < touching && nearest > 0 && nearest < 1 &&
                         std::abs(dot(way, normal)) < 0.1 * along;
    if (is_wall) return limit(dot(turned(way), normal) > 0 ? 0 : 1, 0, nearest);
    const auto touch = circle_to(from, normal, near.from(), way);
    if (!touch) return;
    if (beside > -touching) limit(1, touch->radius, touch->share);
    if (beside < touching) limit(0, touch->radius, touch->share);
  };
  // Nearby edges first: the circles that reach them are small, and then no larger one matters.
  for (double looked_at = std::min(boundary_.cell() / 2, by);;
       looked_at = std::min(2 * looked_at, most)) {
    const Vector middle = from + normal * looked_at;
    const Vector corner{looked_at + touching, looked_at + touching};
    boundary_.for_each_near(middle - corner, middle + corner, [&](const BoundaryMap::Near& near) {
      look_at(near, std::min(looked_at, most));
    });
    if (most <= looked_at) break;
  }
  return std::max(most, 0.0);
}

double Exaggeration::limited_by_neighbour(std::uint32_t side, double share, double by) {
  if (by <= 0 || boundary_.face_of(side ^ 1U) == BoundaryMap::kNoFace) return by;
  return std::min(by, std::max(0.0, -signed_growth(side ^ 1U, share)));
}

double Exaggeration::growth_at_end(std::uint32_t side, bool is_at_head) {
  const bool is_lower = is_forward(side) == is_at_head;
  const At at{side, is_lower ? rows_[side / 2].steps : 0};
  if (!has_sample(at)) return 0;
  return limited_by_neighbour(side, is_lower ? 1 : 0, growth(at));
}

/// The direction in which a side is traversed.
Vector Exaggeration::way_of(std::uint32_t side) const {
  const Vector way = boundary_.edges()[side / 2].way();
  return is_forward(side) ? way : way * -1;
}

/// The turn at the end of a side.
Exaggeration::Turn Exaggeration::turn_between(std::uint32_t side, std::uint32_t next) const {
  const Vector one = way_of(side);
  const Vector other = way_of(next);
  const double angle = std::atan2(cross(one, other), dot(one, other));
  return {std::sin(angle), std::cos(angle)};
}

/// Where the boundary turns away from the face: how far from the end of the side, and from the
/// beginning of the next, their moved lines meet.
std::optional<std::array<double, 2>> Exaggeration::fold_between(std::uint32_t side,
                                                                std::uint32_t next) {
  if (cross(way_of(side), way_of(next)) >= 0) return std::nullopt;
  const Turn turn = turn_between(side, next);
  if (is_straight(turn.sine, turn.cosine)) return std::nullopt;
  const double one = growth_at_end(side, true);
  const double other = growth_at_end(next, false);
  const double sine = std::abs(turn.sine);
  const auto from_end = [&](double own, double theirs) {
    return std::max(0.0, (theirs - own * turn.cosine) / std::max(sine, 1e-9));
  };
  const std::array<double, 2> gone{from_end(one, other), from_end(other, one)};
  return gone;
}

// ---- moving

void Exaggeration::move_side(std::uint32_t side) {
  const BoundaryMap::Edge& edge = boundary_.edges()[side / 2];
  if (edge.is_cut || boundary_.face_of(side) == BoundaryMap::kNoFace) return;
  const Row& row = rows_[side / 2];
  const auto seen = shares_in(around_box_, edge.from(), edge.way());
  if (!seen || row.steps == 0) return;
  const auto strip = [&](double share, double round) {
    const double strips = share * row.steps / kStepsOfStrip;
    return static_cast<std::int32_t>(std::floor(strips + round)) * kStepsOfStrip;
  };
  const std::int32_t first = std::max(strip(seen->first, 0), row.first);
  const std::int32_t last =
      std::min({strip(seen->second, 1), row.steps, row.first + row.count - 1});
  bool grows = false;
  for (std::int32_t i = first; i <= last && !grows; ++i) grows = growth({side, i}) > 0;
  if (!grows) return;

  const double along = length(edge.way());
  std::array<std::uint32_t, 3> exempt{side / 2, kNone, kNone};
  std::array<double, 2> gone{};  // at the upper and the lower end
  for (const bool is_at_head : {false, true}) {
    const std::uint32_t other = is_at_head ? boundary_.next(side) : boundary_.before(side);
    if (other == kNone) continue;
    const std::uint32_t one = is_at_head ? side : other;
    const std::uint32_t next = is_at_head ? other : side;
    const auto fold = fold_between(one, next);
    const auto has_room = [this](double is_gone, std::uint32_t of) {
      return is_gone <= length(boundary_.edges()[of / 2].way()) / 2;
    };
    if (fold) {
      double& own = gone[is_forward(side) == is_at_head ? 1 : 0];
      own = std::min((*fold)[is_at_head ? 0 : 1], along / 2);
    }
    if (!fold || (has_room((*fold)[0], one) && has_room((*fold)[1], next))) {
      exempt[is_at_head ? 1 : 2] = other / 2;
    }
  }
  for (double& length_gone : gone) {
    if (length_gone < kTouching * pixel_) length_gone = 0;
  }

  const auto begin = moved_.size();
  const Vector outward = inward(side) * -1;
  const auto move = [&](Vector from, double share, double by) {
    const double wanted = limited_by_neighbour(side, share, by);
    const double moves = limited(from, outward, wanted, exempt);
    moved_.push_back({share, moves < kLeastMove * pixel_ ? 0 : moves});
  };
  const auto move_between = [&](double share) {
    move(edge.from() + edge.way() * share, share, positive_growth(side, share));
  };
  const double upper = gone[0] / along;
  const double lower = 1 - gone[1] / along;
  for (std::int32_t i = first; i <= last; ++i) {
    const double share = static_cast<double>(i) / row.steps;
    const bool is_lower_end = i == row.steps && gone[1] > 0;
    if (is_lower_end) move_between(lower);
    if ((i == 0 && gone[0] > 0) || is_lower_end) {
      moved_.push_back({share, 0, true});
      if (i == 0) move_between(upper);
      continue;
    }
    if (share <= upper && gone[0] > 0) continue;
    if (share >= lower && gone[1] > 0) continue;
    move(place({side, i}), share, growth({side, i}));
  }
  straighten(begin, row.steps);
  const auto moves = [](const Moved& one) { return one.by > 0; };
  if (!std::any_of(moved_.begin() + static_cast<std::ptrdiff_t>(begin), moved_.end(), moves)) {
    moved_.resize(begin);
    return;
  }
  moved_sides_.push_back(
      {side, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(moved_.size() - begin)});
}

/// Drops places that lie on the line between those before and after them.
void Exaggeration::straighten(std::size_t first, std::int32_t steps) {
  std::size_t kept = first + 1;
  for (std::size_t i = first + 1; i < moved_.size(); ++i) {
    const Moved one = moved_[i];
    const double strips = one.share * steps / kStepsOfStrip;
    bool is_kept = i + 1 == moved_.size() || strips == std::floor(strips) || one.is_folded;
    if (!is_kept) {
      const Moved& last = moved_[kept - 1];
      const Moved& next = moved_[i + 1];
      const double share = (one.share - last.share) / (next.share - last.share);
      const double on_line = last.by + (next.by - last.by) * share;
      is_kept = std::abs(one.by - on_line) > kLeastBend * pixel_;
    }
    if (is_kept) moved_[kept++] = one;
  }
  moved_.resize(std::min(kept, moved_.size()));
}

Point Exaggeration::place_of(std::uint32_t side, const Moved& moved) const {
  const BoundaryMap::Edge& edge = boundary_.edges()[side / 2];
  const Vector at = edge.from() + edge.way() * moved.share;
  return to_point(at - inward(side) * moved.by);
}

void Exaggeration::append_strip(const MovedSide& moved) {
  const BoundaryMap::Face face = boundary_.face_of(moved.side);
  const bool is_beside = is_beside_others(moved.side);
  const std::span<const Moved> places = std::span(moved_).subspan(moved.first, moved.count);
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Moved& one = places[i - 1];
    const Moved& other = places[i];
    if (one.by == 0 && other.by == 0) continue;
    const Point a = place_of(moved.side, {one.share, 0});
    const Point b = place_of(moved.side, {other.share, 0});
    const Point moved_a = place_of(moved.side, one);
    const Point moved_b = place_of(moved.side, other);
    append_triangle(face, is_beside, {a, b, moved_b});
    append_triangle(face, is_beside, {a, moved_b, moved_a});
  }
}

void Exaggeration::append_corner(std::uint32_t side, std::uint32_t next) {
  const MovedSide* moved = find_moved(side);
  const MovedSide* moved_next = find_moved(next);
  if (moved == nullptr && moved_next == nullptr) return;
  const BoundaryMap::Edge& edge = boundary_.edges()[side / 2];
  const BoundaryMap::Face face = boundary_.face_of(side);
  const Vector at = to_vector(is_forward(side) ? edge.lower : edge.upper);
  const Point corner = to_point(at);
  const double one = moved_end(side, true);
  const double other = moved_end(next, false);
  const Point begin = end_place(side, true);
  const Point end = to_point(at - inward(next) * other);
  const Turn turn = turn_between(side, next);
  const bool is_straight_on = is_straight(turn.sine, turn.cosine);
  const bool is_beside = is_beside_others(side) || is_beside_others(next);
  std::optional<Vector> tip;
  if (turn.sine >= 0 && !is_straight_on) tip = tip_between(side, next, one, other);
  if (tip) {
    const Point middle = to_point(at + *tip);
    append_triangle(face, is_beside, {corner, begin, middle});
    append_triangle(face, is_beside, {corner, middle, end});
    tips_.push_back({side, middle});
    return;
  }
  if ((turn.sine >= 0 || is_straight_on) && orientation(corner, begin, end) > 0) {
    append_triangle(face, is_beside, {corner, begin, end});
  }
  if (begin != end_place(next, false)) tips_.push_back({side, begin});
}

/// Where the moved boundary of a side ends, or begins.
Point Exaggeration::end_place(std::uint32_t side, bool is_at_head) const {
  const BoundaryMap::Edge& edge = boundary_.edges()[side / 2];
  const bool is_lower = is_forward(side) == is_at_head;
  const Point vertex = is_lower ? edge.lower : edge.upper;
  const MovedSide* moved = find_moved(side);
  if (moved == nullptr) return vertex;
  const std::span<const Moved> places = std::span(moved_).subspan(moved->first, moved->count);
  const Moved& end = is_lower ? places.back() : places.front();
  if (end.share != (is_lower ? 1 : 0)) return vertex;
  if (!end.is_folded || places.size() < 2) return place_of(side, end);
  return place_of(side, is_lower ? places[places.size() - 2] : places[1]);
}

/// Where the moved lines of two sides meet, relative to their common end.
std::optional<Vector> Exaggeration::tip_between(std::uint32_t side, std::uint32_t next, double one,
                                                double other) {
  if (one == 0 && other == 0) return std::nullopt;
  const Turn turn = turn_between(side, next);
  const double sine = std::max(turn.sine, 1e-9);
  const double on = (other - one * turn.cosine) / sine;
  const double back = (one - other * turn.cosine) / sine;
  if (on <= 0 || back <= 0) return std::nullopt;
  const BoundaryMap::Edge& edge = boundary_.edges()[side / 2];
  const Vector inner = inward(side);
  const Vector along{inner.y, -inner.x};  // the direction of the side
  const Vector tip = inner * -one + along * on;
  const double far = length(tip);
  const Vector direction = tip * (1 / far);
  const Vector at = to_vector(is_forward(side) ? edge.lower : edge.upper);
  const double most = std::min(far, kMostOfTip * std::max(one, other));
  return direction * limited(at, direction, most, {side / 2, next / 2, kNone});
}

const Exaggeration::MovedSide* Exaggeration::find_moved(std::uint32_t side) const {
  const std::uint32_t number = number_of_moved_[side];
  return number == kNone ? nullptr : &moved_sides_[number];
}

void Exaggeration::number_moved_sides() {
  number_of_moved_.assign(2 * boundary_.edges().size(), kNone);
  for (std::uint32_t i = 0; i < moved_sides_.size(); ++i) {
    number_of_moved_[moved_sides_[i].side] = i;
  }
}

const Exaggeration::Tip* Exaggeration::find_tip(std::uint32_t side) const {
  const auto found = std::ranges::lower_bound(tips_, side, {}, &Tip::side);
  return found != tips_.end() && found->side == side ? &*found : nullptr;
}

double Exaggeration::moved_end(std::uint32_t side, bool is_at_head) const {
  const MovedSide* moved = find_moved(side);
  if (moved == nullptr) return 0;
  const bool is_lower = is_forward(side) == is_at_head;
  const Moved& end = moved_[is_lower ? moved->first + moved->count - 1 : moved->first];
  return end.share == (is_lower ? 1 : 0) ? end.by : 0;
}

// Across a void, nothing is grown over.
bool Exaggeration::is_beside_others(std::uint32_t side) const {
  return boundary_.face_of(side ^ 1U) != BoundaryMap::kNoFace;
}

void Exaggeration::append_triangle(BoundaryMap::Face face, bool is_beside_others,
                                   const std::array<Point, 3>& corners) {
  if (orientation(corners[0], corners[1], corners[2]) == 0) return;
  Triangle triangle{face, corners, is_beside_others};
  std::ranges::sort(triangle.corners, is_above);
  Box around;
  for (const Point p : corners) around.include(p);
  if (!around.intersects(box_)) return;
  (is_beside_others ? beside_others_ : triangles_).push_back(triangle);
}

void Exaggeration::sort_triangles() {
  std::ranges::stable_sort(beside_others_, {}, [](const Triangle& t) {
    return std::pair(t.corners[0].y, t.corners[0].x);
  });
  highest_ = 0;
  for (const Triangle& t : beside_others_) {
    highest_ = std::max(highest_, t.corners[2].y - t.corners[0].y);
  }
  triangles_.insert(triangles_.end(), beside_others_.begin(), beside_others_.end());
}

// ---- drawing

void Exaggeration::trace(std::uint32_t piece, const MeshView& mesh, std::uint32_t edge,
                         std::vector<PlateCarreeMesh::PointOnWay>& way) const {
  way.clear();
  const std::uint32_t number = boundary_.edge_number(piece, edge);
  std::array<std::span<const Moved>, 2> places;
  for (std::uint32_t i = 0; i < 2 && number != kNone; ++i) {
    const MovedSide* moved = find_moved(2 * number + i);
    if (moved != nullptr) places[i] = std::span(moved_).subspan(moved->first, moved->count);
  }
  // Where one of the sides moves, the other does not.
  std::vector<std::pair<double, Point>> moved;
  std::array<const Tip*, 2> tips{};  // at the upper and the lower end
  for (std::uint32_t i = 0; i < 2 && number != kNone; ++i) {
    const std::uint32_t side = 2 * number + i;
    const std::uint32_t last = boundary_.before(side);
    const std::size_t head = is_forward(side) ? 1 : 0;
    if (const Tip* tip = find_tip(side)) tips[head] = tip;
    if (const Tip* tip = last == kNone ? nullptr : find_tip(last)) tips[1 - head] = tip;
    for (const Moved& one : places[i]) {
      const bool is_others = one.by == 0 && moved_by(places[1 - i], one.share) > 0;
      if (!one.is_folded && !is_others) moved.emplace_back(one.share, place_of(side, one));
    }
  }
  std::ranges::sort(moved, {}, &std::pair<double, Point>::first);
  const auto reaches = [&places](double end) {
    return std::ranges::any_of(places, [end](std::span<const Moved> of_side) {
      return !of_side.empty() && (of_side.front().share == end || of_side.back().share == end);
    });
  };
  const auto append = [&way](Point place, double share) {
    if (way.empty() || way.back().place != place) way.push_back({place, share});
  };
  const MeshEdge& ends = mesh.edges[edge];
  if (tips[0] != nullptr) append(tips[0]->at, 0);
  if (!reaches(0)) append(mesh.vertices[ends.upper], 0);
  for (const auto& [share, place] : moved) append(place, share);
  if (!reaches(1)) append(mesh.vertices[ends.lower], 1);
  if (tips[1] != nullptr) append(tips[1]->at, 1);
}

/// The distance by which a side has moved at that fraction of its edge.
double Exaggeration::moved_by(std::span<const Moved> places, double share) {
  const auto next = std::ranges::upper_bound(places, share, {}, &Moved::share);
  if (next == places.begin() || places.empty()) return 0;
  const Moved& last = *(next - 1);
  if (next == places.end()) return last.share == share ? last.by : 0;
  return last.by + (next->by - last.by) * (share - last.share) / (next->share - last.share);
}

void Exaggeration::append(const Triangle& triangle, std::vector<Point>& vertices,
                          std::vector<MeshEdge>& edges, std::vector<MeshTrapezoid>& trapezoids) {
  const auto v = static_cast<std::uint32_t>(vertices.size());
  const auto e = static_cast<std::uint32_t>(edges.size());
  const auto& [top, middle, bottom] = triangle.corners;
  vertices.insert(vertices.end(), {top, middle, bottom});
  edges.insert(edges.end(), {{v, v + 2}, {v, v + 1}, {v + 1, v + 2}});
  const bool is_middle_east = orientation(top, bottom, middle) < 0;
  const auto add = [&](std::uint32_t from, std::uint32_t to, std::uint32_t side) {
    if (vertices[from].y == vertices[to].y) return;
    trapezoids.push_back({from, to, is_middle_east ? e : side, is_middle_east ? side : e});
  };
  add(v, v + 1, e + 1);
  add(v + 1, v + 2, e + 2);
}

void Exaggeration::append_common(const MeshView& mesh, const MeshTrapezoid& trapezoid,
                                 std::vector<Point>& vertices, std::vector<MeshEdge>& edges,
                                 std::vector<MeshTrapezoid>& trapezoids) const {
  if (triangles_.empty() || !triangles_.back().is_beside_others) return;
  const auto ends_of = [&mesh](std::uint32_t edge) {
    return Ends{mesh.vertices[mesh.edges[edge].upper], mesh.vertices[mesh.edges[edge].lower]};
  };
  const Ends west = ends_of(trapezoid.left);
  const Ends east = ends_of(trapezoid.right);
  const std::int32_t top = mesh.vertices[trapezoid.top].y;
  const std::int32_t bottom = mesh.vertices[trapezoid.bottom].y;
  if (top >= bottom) return;
  const auto from = std::min({west.upper.x, west.lower.x});
  const auto to = std::max({east.upper.x, east.lower.x});
  const auto first = std::ranges::lower_bound(
      triangles_, std::pair(true, std::int64_t{top} - highest_), {}, [](const Triangle& t) {
        return std::pair(t.is_beside_others, std::int64_t{t.corners[0].y});
      });
  for (auto it = first; it != triangles_.end() && it->corners[0].y < bottom; ++it) {
    const auto& [a, b, c] = it->corners;
    if (c.y <= top || std::max({a.x, b.x, c.x}) <= from || std::min({a.x, b.x, c.x}) >= to) {
      continue;
    }
    const bool is_middle_east = orientation(a, c, b) < 0;
    const Ends through{a, c};
    for (const Ends& other : {Ends{a, b}, Ends{b, c}}) {
      const std::array<Ends, 2> wests{west, is_middle_east ? through : other};
      const std::array<Ends, 2> easts{east, is_middle_east ? other : through};
      append_cut(wests, easts, std::max(top, other.upper.y), std::min(bottom, other.lower.y),
                 vertices, edges, trapezoids);
    }
  }
}

}  // namespace trapeze
