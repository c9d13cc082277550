#include "core/labels/label_anchors.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "core/grid/for_each_in_parallel.h"
#include "core/grid/ring_box.h"

namespace trapeze {
namespace {

constexpr std::size_t kRowsAtOnce = 256;
// A part that is too fine to be searched to the end has the best point of so many.
constexpr int kMostProbes = 2'000;

double area_of_ring(std::span<const Point> ring) {
  double twice = 0;
  const Point origin = ring.front();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point a = ring[i];
    const Point b = ring[i + 1 == ring.size() ? 0 : i + 1];
    twice += (static_cast<double>(a.x) - origin.x) * (static_cast<double>(b.y) - origin.y) -
             (static_cast<double>(b.x) - origin.x) * (static_cast<double>(a.y) - origin.y);
  }
  return std::abs(twice) / 2;
}

/// Sides of a ring to be found by height.
class RingIndex {
 public:
  explicit RingIndex(std::span<const Point> ring) : ring_(ring), box_(box_of(ring)) {
    if (ring.size() < kLeastSides) return;
    rows_.resize(std::min(ring.size() / kSidesPerRow, kMostRows));
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const auto [low, high] = heights(i);
      for (std::size_t row = row_at(low); row <= row_at(high); ++row) {
        rows_[row].push_back(static_cast<std::uint32_t>(i));
      }
    }
  }

  /// Whether a ray from the point to the west crosses the ring an odd number of times.
  bool holds(double x, double y) const {
    bool is_inside = false;
    const auto cross = [&](std::size_t i) {
      const Point a = ring_[i];
      const Point b = ring_[next(i)];
      if ((a.y > y) == (b.y > y)) return;
      const double share = (y - a.y) / (static_cast<double>(b.y) - a.y);
      if (a.x + share * (static_cast<double>(b.x) - a.x) < x) is_inside = !is_inside;
    };
    if (rows_.empty()) {
      for (std::size_t i = 0; i < ring_.size(); ++i) cross(i);
    } else if (y >= box_.min_y && y <= box_.max_y) {
      for (const std::uint32_t i : rows_[row_at(y)]) cross(i);
    }
    return is_inside;
  }

 private:
  static constexpr std::size_t kLeastSides = 64;
  static constexpr std::size_t kSidesPerRow = 4;
  static constexpr std::size_t kMostRows = 4096;

  std::size_t next(std::size_t i) const { return i + 1 == ring_.size() ? 0 : i + 1; }
  std::pair<double, double> heights(std::size_t i) const {
    const std::int32_t a = ring_[i].y;
    const std::int32_t b = ring_[next(i)].y;
    return {std::min(a, b), std::max(a, b)};
  }
  std::size_t row_at(double y) const {
    const double height = static_cast<double>(box_.max_y) - box_.min_y + 1;
    return static_cast<std::size_t>((y - box_.min_y) / height * static_cast<double>(rows_.size()));
  }

  std::span<const Point> ring_;
  Box box_;
  std::vector<std::vector<std::uint32_t>> rows_;  // empty: there are few sides
};

/// Rings do not cross, but touch: the middle of a side tells what a vertex that both have does not.
bool lies_in(std::span<const Point> inner, const RingIndex& outer) {
  const Point a = inner[0];
  const Point b = inner[1 % inner.size()];
  return outer.holds((static_cast<double>(a.x) + b.x) / 2, (static_cast<double>(a.y) + b.y) / 2);
}

/// An outer ring and the holes in it, by numbers.
struct Part {
  std::size_t outer = 0;
  std::vector<std::size_t> holes;
  double area = 0;
};

/// Of rings that are nested by even-odd.
std::vector<Part> parts_of(const Rings& rings) {
  struct Ring {
    std::size_t number = 0;
    Box box;
    double area = 0;
    bool is_hole = false;
    std::size_t part = 0;
    std::optional<RingIndex> index = {};  // once it is needed
  };
  std::vector<Ring> from_west;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (rings[i].size() < 3) continue;
    from_west.push_back({i, box_of(rings[i]), area_of_ring(rings[i])});
  }
  std::ranges::sort(from_west, [](const Ring& a, const Ring& b) {
    return std::tuple(a.box.min_x, -a.area, a.number) < std::tuple(b.box.min_x, -b.area, b.number);
  });
  std::vector<Part> parts;
  std::vector<std::size_t> open;  // those that reach as far east as the ring at hand begins
  for (std::size_t i = 0; i < from_west.size(); ++i) {
    Ring& ring = from_west[i];
    const Ring* around = nullptr;  // the smallest
    std::erase_if(open, [&](std::size_t k) {
      Ring& other = from_west[k];
      if (other.box.max_x < ring.box.min_x) return true;
      const bool is_nearer = around == nullptr || other.area < around->area;
      if (!is_nearer || !holds(other.box, ring.box)) return false;
      if (!other.index) other.index.emplace(rings[other.number]);
      if (lies_in(rings[ring.number], *other.index)) around = &other;
      return false;
    });
    ring.is_hole = around != nullptr && !around->is_hole;
    if (ring.is_hole) {
      ring.part = around->part;
      parts[ring.part].holes.push_back(ring.number);
      parts[ring.part].area -= ring.area;
    } else {
      ring.part = parts.size();
      parts.push_back({ring.number, {}, ring.area});
    }
    open.push_back(i);
  }
  std::ranges::sort(parts, [](const Part& a, const Part& b) {
    return std::tuple(-a.area, a.outer) < std::tuple(-b.area, b.outer);
  });
  return parts;
}

/// Sides of boundaries, drawn narrower. Small rings count less: a name may lie over a pond, and
/// need not keep away from it as from the border of its country.
class Boundary {
 public:
  void clear() {
    sides_.clear();
    is_small_.clear();
  }
  /// Begins a polygon. Inside is what is within the first, by even-odd, and within none of the
  /// others.
  void begin_polygon(bool is_small) { is_small_.push_back(is_small ? 1 : 0); }
  void add(std::span<const Point> ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point a = ring[i];
      const Point b = ring[i + 1 == ring.size() ? 0 : i + 1];
      if (a == b) continue;
      Side side{a.x / LabelAnchors::kSqueeze,
                static_cast<double>(a.y),
                (static_cast<double>(b.x) - a.x) / LabelAnchors::kSqueeze,
                static_cast<double>(b.y) - a.y,
                0,
                static_cast<std::uint32_t>(is_small_.size() - 1)};
      side.by_square = 1 / (side.dx * side.dx + side.dy * side.dy);
      sides_.push_back(side);
    }
  }
  /// To be called once all have been added.
  void sort(const Box& box) {
    constexpr std::size_t kSidesPerRow = 4;
    constexpr std::size_t kMostRows = 4096;
    top_ = box.min_y;
    const std::size_t rows = std::clamp<std::size_t>(sides_.size() / kSidesPerRow, 1, kMostRows);
    row_height_ =
        std::max((static_cast<double>(box.max_y) - box.min_y) / static_cast<double>(rows), 1e-3);
    rows_.resize(std::max(rows_.size(), rows));
    row_count_ = rows;
    for (std::size_t i = 0; i < rows; ++i) rows_[i].clear();
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const Side& side = sides_[i];
      const double low = std::min(side.y, side.y + side.dy);
      const double high = std::max(side.y, side.y + side.dy);
      if (high < top_ || low > box.max_y) continue;
      for (std::size_t row = row_at(low); row <= row_at(high); ++row) {
        rows_[row].push_back(static_cast<std::uint32_t>(i));
      }
    }
  }

  std::size_t size() const { return sides_.size(); }

  /// How far a side is from the place.
  double distance(std::uint32_t number, double x, double y) const {
    const Side& side = sides_[number];
    const double px = x - side.x;
    const double py = y - side.y;
    const double along = std::clamp((px * side.dx + py * side.dy) * side.by_square, 0.0, 1.0);
    return std::hypot(px - along * side.dx, py - along * side.dy);
  }

  bool is_small(std::uint32_t number) const { return is_small_[sides_[number].polygon] != 0; }

  /// Whether the place is inside as far as the large rings go, and as far as the small ones do.
  struct Inside {
    bool of_large = false;
    bool of_small = false;
  };
  Inside inside(double x, double y) {
    is_odd_.assign(is_small_.size(), 0);
    for (const std::uint32_t i : rows_[row_at(y)]) {
      const Side& side = sides_[i];
      const double px = x - side.x;
      const double py = y - side.y;
      const bool is_crossed = (py < 0) != (py < side.dy);
      if (is_crossed && (px * side.dy > py * side.dx) == (side.dy > 0)) is_odd_[side.polygon] ^= 1;
    }
    Inside inside{is_odd_.front() != 0, true};
    for (std::size_t i = 1; i < is_odd_.size(); ++i) {
      if (is_odd_[i] == 0) continue;
      (is_small_[i] != 0 ? inside.of_small : inside.of_large) = false;
    }
    return inside;
  }

 private:
  struct Side {
    double x;
    double y;
    double dx;
    double dy;
    double by_square;  // 1 / (dx^2 + dy^2)
    std::uint32_t polygon;
  };

  std::size_t row_at(double y) const {
    const double row =
        std::clamp((y - top_) / row_height_, 0.0, static_cast<double>(row_count_ - 1));
    return static_cast<std::size_t>(row);
  }

  std::vector<Side> sides_;
  std::vector<std::uint8_t> is_small_;  // by polygon
  double top_ = 0;
  double row_height_ = 1;
  std::size_t row_count_ = 0;
  std::vector<std::vector<std::uint32_t>> rows_;  // the sides that reach into each, by height
  std::vector<std::uint8_t> is_odd_;              // by polygon
};

/// A square in which the deepest point may lie.
struct Square {
  double x = 0;
  double y = 0;
  double half = 0;
  double to_large = 0;  // from its centre to the nearest large ring, negative where that is outside
  double to_small = 0;  // the same of small ones
  std::vector<std::uint32_t> sides = {};  // those that may be nearest to a place in it

  double half_diagonal() const { return half * std::sqrt(2.0); }
  double depth() const { return std::min(to_large, LabelAnchors::kSmallRings * to_small); }
  /// No point in it is deeper.
  double most() const {
    return std::min(to_large + half_diagonal(),
                    LabelAnchors::kSmallRings * (to_small + half_diagonal()));
  }
};

/// The square with its depth, and with those of the sides that may be nearest somewhere in it: no
/// side does that is farther from the centre than the nearest one by more than a diagonal.
Square probe(Boundary& boundary, double x, double y, double half,
             std::span<const std::uint32_t> sides, std::vector<double>& distances) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Square square{x, y, half, kFar, kFar};
  distances.clear();
  for (const std::uint32_t side : sides) {
    distances.push_back(boundary.distance(side, x, y));
    double& nearest = boundary.is_small(side) ? square.to_small : square.to_large;
    nearest = std::min(nearest, distances.back());
  }
  const double diagonal = 2 * square.half_diagonal();
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const double nearest = boundary.is_small(sides[i]) ? square.to_small : square.to_large;
    if (distances[i] <= nearest + diagonal) square.sides.push_back(sides[i]);
  }
  const Boundary::Inside inside = boundary.inside(x, y);
  if (!inside.of_large) square.to_large = -square.to_large;
  if (!inside.of_small) square.to_small = -square.to_small;
  return square;
}

/// The deepest point, by squares that are divided where it may lie; its place is not whole yet.
Square deepest(Boundary& boundary, const Box& box) {
  const double min_x = box.min_x / LabelAnchors::kSqueeze;
  const double width = box.max_x / LabelAnchors::kSqueeze - min_x;
  const double height = static_cast<double>(box.max_y) - box.min_y;
  // Long ones are divided into as many squares as fit.
  const double side = std::max({std::min(width, height), std::max(width, height) / 32, 1.0});
  std::vector<std::uint32_t> all(boundary.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);
  std::vector<double> distances;
  std::vector<Square> open;  // a heap
  const auto is_worse = [](const Square& a, const Square& b) { return a.most() < b.most(); };
  Square best;
  best.to_large = -std::numeric_limits<double>::infinity();
  int probes = 0;
  const auto take = [&](Square square) {
    ++probes;
    if (square.depth() > best.depth()) {
      best = {square.x, square.y, square.half, square.to_large, square.to_small};
    }
    open.push_back(std::move(square));
    std::ranges::push_heap(open, is_worse);
  };
  const auto columns = static_cast<int>(std::ceil(width / side));
  const auto rows = static_cast<int>(std::ceil(height / side));
  for (int column = 0; column < columns; ++column) {
    for (int row = 0; row < rows; ++row) {
      take(probe(boundary, min_x + (column + 0.5) * side, box.min_y + (row + 0.5) * side, side / 2,
                 all, distances));
    }
  }
  while (!open.empty() && probes < kMostProbes) {
    std::ranges::pop_heap(open, is_worse);
    const Square square = std::move(open.back());
    open.pop_back();
    const double wanted = best.depth() + std::max(best.depth() * LabelAnchors::kDepthShare, 0.5);
    if (square.most() <= wanted) break;
    const double quarter = square.half / 2;
    for (const double x : {square.x - quarter, square.x + quarter}) {
      for (const double y : {square.y - quarter, square.y + quarter}) {
        take(probe(boundary, x, y, quarter, square.sides, distances));
      }
    }
  }
  return best;
}

/// Reused from feature to feature for its memory.
class Finder {
 public:
  Rings rings;  // of the feature
  /// Begins without any that lie over the feature.
  void clear_above() { above_.clear(); }
  void add_above(const Rings& other) {
    Above& above = above_.emplace_back();
    above.rings = &other;
    for (std::size_t i = 0; i < other.size(); ++i) {
      above.boxes.push_back(box_of(other[i]));
      above.box.include(above.boxes.back());
      above.area = std::max(above.area, area_of_ring(other[i]));
    }
  }

  void find(std::uint32_t row, LabelParts parts, std::vector<LabelAnchor>& anchors) {
    for (const Part& part : parts_of(rings)) {
      const Box box = box_of(rings[part.outer]);
      const double small = part.area * LabelAnchors::kSmallShare;
      boundary_.clear();
      boundary_.begin_polygon(false);
      boundary_.add(rings[part.outer]);
      const auto add_holes = [&](bool are_small) {
        for (const std::size_t hole : part.holes) {
          if ((area_of_ring(rings[hole]) < small) == are_small) boundary_.add(rings[hole]);
        }
      };
      add_holes(false);
      boundary_.begin_polygon(true);
      add_holes(true);
      for (const Above& above : above_) {
        if (!above.box.intersects(box)) continue;
        boundary_.begin_polygon(above.area < small);
        for (std::size_t i = 0; i < above.boxes.size(); ++i) {
          if (above.boxes[i].intersects(box)) boundary_.add((*above.rings)[i]);
        }
      }
      boundary_.sort(box);
      const Square found = deepest(boundary_, box);
      // In whole cells.
      const double x = std::round(found.x * LabelAnchors::kSqueeze);
      const double y = std::round(found.y);
      const double moved = std::hypot(x / LabelAnchors::kSqueeze - found.x, y - found.y);
      const double depth =
          std::min(found.to_large - moved, LabelAnchors::kSmallRings * (found.to_small - moved));
      if (depth <= 0) continue;
      anchors.push_back({row,
                         {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)},
                         static_cast<float>(depth),
                         static_cast<float>(part.area)});
      if (parts == LabelParts::largest) return;
    }
  }

 private:
  struct Above {
    const Rings* rings = nullptr;
    std::vector<Box> boxes;  // of its rings
    Box box;                 // around all
    double area = 0;         // of the largest
  };

  Boundary boundary_;
  std::vector<Above> above_;
};

void find_rows(const Layer& layer, LabelParts parts, std::uint32_t first, std::uint32_t end,
               std::vector<LabelAnchor>& anchors) {
  Finder finder;
  std::deque<Rings> above;
  for (std::uint32_t row = first; row < end; ++row) {
    if (layer.is_removed(row)) continue;
    finder.rings.clear();
    layer.append_outline(row, finder.rings);
    if (finder.rings.empty()) continue;
    finder.clear_above();
    above.clear();
    for (const FeatureOverlap& overlap : layer.overlaps().of(row)) {
      if (overlap.other < row || layer.is_removed(overlap.other)) continue;
      layer.append_outline(overlap.other, above.emplace_back());
      finder.add_above(above.back());
    }
    finder.find(row, parts, anchors);
  }
}

}  // namespace

LabelAnchors::LabelAnchors(const Layer& layer, LabelParts parts, unsigned threads) {
  const std::size_t rows = layer.features().size();
  std::vector<std::vector<LabelAnchor>> found((rows + kRowsAtOnce - 1) / kRowsAtOnce);
  for_each_in_parallel(found.size(), threads, [&](std::size_t i) {
    const std::size_t first = i * kRowsAtOnce;
    find_rows(layer, parts, static_cast<std::uint32_t>(first),
              static_cast<std::uint32_t>(std::min(first + kRowsAtOnce, rows)), found[i]);
  });
  std::size_t count = 0;
  for (const auto& some : found) count += some.size();
  anchors_.reserve(count);
  for (const auto& some : found) anchors_.insert(anchors_.end(), some.begin(), some.end());
}

LabelAnchors::LabelAnchors(std::span<const LabelAnchor> of_all_parts, LabelParts parts) {
  for (const LabelAnchor& anchor : of_all_parts) {
    const bool is_first = anchors_.empty() || anchors_.back().row != anchor.row;
    if (is_first || parts == LabelParts::all) anchors_.push_back(anchor);
  }
}

std::vector<LabelAnchor> anchors_of_feature(std::uint32_t row, const Rings& rings,
                                            std::span<const Rings> above, LabelParts parts) {
  Finder finder;
  finder.rings = rings;
  for (const Rings& other : above) finder.add_above(other);
  std::vector<LabelAnchor> anchors;
  finder.find(row, parts, anchors);
  return anchors;
}

}  // namespace trapeze
