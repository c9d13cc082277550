#include "core/adapt/shape_weight.h"

#include <algorithm>
#include <cmath>

namespace trapeze {
namespace {

// The factor for the area of a triangle without height.
constexpr double kFlattest = 0.25;
// The factor for a triangle whose tip is above an end of its base, or beyond it.
constexpr double kSkewest = 0.75;
// The factor for a triangle with a right angle: more than twice, so that both far corners of a bump
// are removed before one of its corners is.
constexpr double kRightAngled = 4;
// An angle counts the more as right the nearer it is to a right angle, and not at all from a
// deviation of about 10 degrees on: 1 over the square of its cosine at that limit.
constexpr double kRightness = 33;

double squared_length(Point a, Point b) {
  const double dx = static_cast<double>(a.x) - b.x;
  const double dy = static_cast<double>(a.y) - b.y;
  return dx * dx + dy * dy;
}

/// From kFlattest to 1, which is reached by the area of a triangle at least half as high as its
/// base is long: that of a right angle between equal sides.
double filter_of_flatness(double area, double squared_base) {
  const double height = squared_base > 0 ? std::min(1.0, 4 * area / squared_base) : 1.0;
  return kFlattest + (1 - kFlattest) * height;
}

/// From kSkewest to 1, by the distance of the tip of a triangle from the middle of its base.
double filter_of_skewness(double squared_a, double squared_b, double squared_base) {
  const double off = std::abs(squared_a - squared_b);
  return 1 - (1 - kSkewest) * (off < squared_base ? off / squared_base : 1.0);
}

double dot_at(Point v, Point p, Point q) {
  return (static_cast<double>(p.x) - v.x) * (static_cast<double>(q.x) - v.x) +
         (static_cast<double>(p.y) - v.y) * (static_cast<double>(q.y) - v.y);
}

/// From 0 to 1, which means that the angle at v is right. Symmetric in p and q to the last bit,
/// like everything here.
double rightness(Point p, Point v, Point q) {
  const double to_p = squared_length(v, p);
  const double to_q = squared_length(v, q);
  if (to_p == 0 || to_q == 0) return 0;
  const double dot = dot_at(v, p, q);
  const double cosine = (dot / std::min(to_p, to_q)) * (dot / std::max(to_p, to_q));
  return std::max(0.0, 1 - kRightness * cosine);
}

/// From 0 to 1, which means that an edge from p to q is parallel to the one from p to v, or at a
/// right angle to it.
double alignment(Point p, Point v, Point q) {
  const double to_v = squared_length(p, v);
  const double to_q = squared_length(p, q);
  if (to_v == 0 || to_q == 0) return 1;
  const auto cross = static_cast<double>(orientation(p, v, q));
  const double product = (cross / to_v) * (dot_at(p, v, q) / to_q);  // product of sine and cosine
  return std::max(0.0, 1 - kRightness * product * product);
}

}  // namespace

double cost_of_vertex(Point p, Point v, Point q) {
  const double area = triangle_area(p, v, q);
  if (area == 0) return 0;
  const double squared_base = squared_length(p, q);
  const double filter =
      filter_of_flatness(area, squared_base) *
      filter_of_skewness(squared_length(v, p), squared_length(v, q), squared_base);
  return area * (filter + rightness(p, v, q) * (kRightAngled - filter));
}

// If both angles are right, and the new edge is neither parallel nor at right angles to the old
// ones, right angles are lost, as in the removal of one vertex. So a step is removed as a pair if
// it is low compared with the length of its walls, and a bump in any case.
//
// Where v and w lie on different sides of the line pq, vw crosses it and there are two triangles:
//
//        v
//       /'.
//      /   '.            of the triangle pvw, the share of vw that lies on the side of v,
//     p------'.------q   and of vwq the share on the side of w
//              '.   /
//                '.w
double cost_of_pair(Point p, Point v, Point w, Point q) {
  const auto of_v = static_cast<double>(orientation(p, q, v));
  const auto of_w = static_cast<double>(orientation(p, q, w));
  double area = 0;
  if ((of_v < 0 && of_w > 0) || (of_v > 0 && of_w < 0)) {
    const double both = std::abs(of_v) + std::abs(of_w);
    area = triangle_area(p, v, w) * (std::abs(of_v) / both) +
           triangle_area(v, w, q) * (std::abs(of_w) / both);
  } else {
    // The area of the quadrangle, from the cross product of its diagonals.
    const double across = (static_cast<double>(w.x) - p.x) * (static_cast<double>(q.y) - v.y);
    const double down = (static_cast<double>(w.y) - p.y) * (static_cast<double>(q.x) - v.x);
    area = std::abs(across - down) / 2;
  }
  if (area == 0) return 0;
  const double filter = filter_of_flatness(area, squared_length(p, q));
  const double right = std::min(rightness(p, v, w), rightness(v, w, q));
  const double lost = right * (1 - std::min(alignment(p, v, q), alignment(q, w, p)));
  return area * (filter + lost * (kRightAngled - filter));
}

/// For a heap with the least cost on top. For equal costs, one vertex comes before two, and then
/// the upper ones come first.
bool ShapeWeights::Candidate::operator<(const Candidate& other) const {
  if (cost != other.cost) return cost > other.cost;
  const bool is_one = first == last;
  if (is_one != (other.first == other.last)) return !is_one;
  return upper != other.upper ? is_above(other.upper, upper) : is_above(other.lower, lower);
}

bool ShapeWeights::is_end(std::size_t v) const {
  return line_ == Line::arc && (v == 0 || v + 1 == points_.size());
}

void ShapeWeights::enqueue(double cost, std::size_t first, std::size_t last) {
  Point upper = points_[first];
  Point lower = points_[last];
  if (is_above(lower, upper)) std::swap(upper, lower);
  queue_.push_back({cost, upper, lower, first, last});
  std::push_heap(queue_.begin(), queue_.end());
}

void ShapeWeights::enqueue_one(std::size_t v) {
  if (is_end(v)) return;
  cost_of_one_[v] = cost_of_vertex(points_[before_[v]], points_[v], points_[after_[v]]);
  enqueue(cost_of_one_[v], v, v);
}

void ShapeWeights::enqueue_pair(std::size_t first) {
  const std::size_t last = after_[first];
  if (left_ < 4 || is_end(first) || is_end(last)) return;
  cost_of_pair_[first] =
      cost_of_pair(points_[before_[first]], points_[first], points_[last], points_[after_[last]]);
  enqueue(cost_of_pair_[first], first, last);
}

/// Whether something has changed since the candidate was enqueued. If the costs are nevertheless
/// the same, so is the effect.
bool ShapeWeights::is_stale(const Candidate& candidate) const {
  const std::size_t first = candidate.first;
  if (before_[first] == kNoIndex) return true;
  if (first == candidate.last) return candidate.cost != cost_of_one_[first];
  return left_ < 4 || after_[first] != candidate.last || candidate.cost != cost_of_pair_[first];
}

void ShapeWeights::weigh(std::span<const Point> points, Line line, std::span<double> weights) {
  const std::size_t n = points.size();
  points_ = points;
  line_ = line;
  left_ = n;
  before_.resize(n);
  after_.resize(n);
  cost_of_one_.resize(n);
  cost_of_pair_.resize(n);
  queue_.clear();
  for (std::size_t i = 0; i < n; ++i) {
    before_[i] = i == 0 ? n - 1 : i - 1;
    after_[i] = i + 1 == n ? 0 : i + 1;
  }
  for (std::size_t i = 0; i < n; ++i) {
    enqueue_one(i);
    enqueue_pair(i);
  }
  double greatest = 0;
  while (left_ > 2) {
    std::pop_heap(queue_.begin(), queue_.end());
    const Candidate next = queue_.back();
    queue_.pop_back();
    if (is_stale(next)) continue;
    greatest = std::max(greatest, next.cost);
    const std::size_t p = before_[next.first];
    const std::size_t q = after_[next.last];
    for (const std::size_t v : {next.first, next.last}) {
      weights[v] = std::sqrt(greatest);
      before_[v] = kNoIndex;
    }
    left_ -= next.first == next.last ? 1 : 2;
    after_[p] = q;
    before_[q] = p;
    if (left_ <= 2) break;
    enqueue_one(p);
    enqueue_one(q);
    enqueue_pair(before_[p]);
    enqueue_pair(p);
    enqueue_pair(q);
  }
}

}  // namespace trapeze
