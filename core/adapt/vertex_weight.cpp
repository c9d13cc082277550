#include "core/adapt/vertex_weight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

namespace trapeze {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

}  // namespace

double squared_distance(Point p, Point a, Point b) {
  return SegmentDistance(a, b).squared(p);
}

std::span<const double> VertexWeights::weigh(std::span<const Point> ring, WeightRule rule) {
  weights_.assign(ring.size(), kInfinite);
  if (rule == WeightRule::effective_area) {
    weigh_by_area(ring, false);
  } else if (rule == WeightRule::shape) {
    shape_.weigh(ring, ShapeWeights::Line::ring, weights_);
  } else {
    weigh_by_distance(ring, rule == WeightRule::raised_parents);
  }
  return weights_;
}

std::span<const double> VertexWeights::weigh_arc(std::span<const Point> arc, WeightRule rule) {
  weights_.assign(arc.size(), kInfinite);
  if (rule == WeightRule::effective_area) {
    weigh_by_area(arc, true);
  } else if (rule == WeightRule::shape) {
    shape_.weigh(arc, ShapeWeights::Line::arc, weights_);
  } else {
    farthest_.assign(arc);
    pieces_.assign(1, {0, arc.size() - 1, kNoIndex});
    split_pieces(arc, rule == WeightRule::raised_parents);
  }
  return weights_;
}

/// The uppermost vertex and the one farthest from it: a choice that depends neither on the first
/// point of the ring nor on its direction.
VertexWeights::Anchors VertexWeights::anchors_of(std::span<const Point> ring) {
  Anchors anchors{0, 0};
  for (std::size_t i = 1; i < ring.size(); ++i) {
    if (is_above(ring[i], ring[anchors.first])) anchors.first = i;
  }
  const Point from = ring[anchors.first];
  double farthest = -1;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const double dx = static_cast<double>(ring[i].x) - from.x;
    const double dy = static_cast<double>(ring[i].y) - from.y;
    const double distance = dx * dx + dy * dy;
    if (distance > farthest || (distance == farthest && is_above(ring[i], ring[anchors.second]))) {
      farthest = distance;
      anchors.second = i;
    }
  }
  return anchors;
}

void VertexWeights::weigh_by_distance(std::span<const Point> ring, bool raise_parents) {
  const std::size_t n = ring.size();
  farthest_.assign(ring);
  const Anchors anchors = anchors_of(ring);
  const std::size_t a = anchors.first;
  const std::size_t b = anchors.second;
  pieces_.clear();
  pieces_.push_back({a, b > a ? b : b + n, kNoIndex});
  pieces_.push_back({b, a > b ? a : a + n, kNoIndex});
  split_pieces(ring, raise_parents);
}

// Binary recursive partitioning of the given pieces, done iteratively.
void VertexWeights::split_pieces(std::span<const Point> points, bool raise_parents) {
  const std::size_t n = points.size();
  splits_.clear();
  while (!pieces_.empty()) {
    const Piece piece = pieces_.back();
    pieces_.pop_back();
    if (piece.end - piece.begin < 2) continue;
    const FarthestVertex::Found split = farthest_.find(piece.begin, piece.end);
    const std::size_t v = split.vertex < n ? split.vertex : split.vertex - n;
    double weight = std::sqrt(split.squared);
    if (!raise_parents && piece.parent != kNoIndex) {
      weight = std::min(weight, weights_[piece.parent]);
    }
    weights_[v] = weight;
    if (raise_parents) splits_.emplace_back(v, piece.parent);
    pieces_.push_back({piece.begin, split.vertex, v});
    pieces_.push_back({split.vertex, piece.end, v});
  }
  for (std::size_t i = splits_.size(); i > 0; --i) {
    const auto [v, parent] = splits_[i - 1];
    if (parent != kNoIndex) weights_[parent] = std::max(weights_[parent], weights_[v]);
  }
}

void VertexWeights::weigh_by_area(std::span<const Point> points, bool is_arc) {
  const std::size_t n = points.size();
  before_.resize(n);
  after_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    before_[i] = i == 0 ? n - 1 : i - 1;
    after_[i] = i + 1 == n ? 0 : i + 1;
  }
  // Smallest area first; of equal areas, the uppermost vertex. An entry is stale once the area of
  // its vertex has changed.
  struct Entry {
    double area;
    Point point;
    std::size_t vertex;
    bool operator<(const Entry& other) const {
      return area != other.area ? area > other.area : is_above(other.point, point);
    }
  };
  std::vector<double> area(n);
  std::priority_queue<Entry> queue;
  const auto enqueue = [&](std::size_t i) {
    area[i] = triangle_area(points[before_[i]], points[i], points[after_[i]]);
    queue.push({area[i], points[i], i});
  };
  const auto is_end = [&](std::size_t i) { return is_arc && (i == 0 || i + 1 == n); };
  for (std::size_t i = 0; i < n; ++i) {
    if (!is_end(i)) enqueue(i);
  }
  double largest = 0;
  for (std::size_t left = n; left > 2;) {
    const Entry entry = queue.top();
    queue.pop();
    const std::size_t i = entry.vertex;
    if (entry.area != area[i] || before_[i] == kNoIndex) continue;
    largest = std::max(largest, entry.area);
    weights_[i] = std::sqrt(largest);
    const std::size_t p = before_[i];
    const std::size_t q = after_[i];
    before_[i] = kNoIndex;
    after_[p] = q;
    before_[q] = p;
    --left;
    if (left > 2) {
      if (!is_end(p)) enqueue(p);
      if (!is_end(q)) enqueue(q);
    }
  }
}

}  // namespace trapeze
