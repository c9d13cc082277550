#include "core/labels/label_anchors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "core/grid/digest.h"
#include "core/grid/for_each_in_parallel.h"
#include "core/grid/ring_box.h"
#include "core/labels/covering_features.h"
#include "core/labels/sides_by_height.h"
#include "core/layer/built_units.h"

namespace trapeze {
namespace {

constexpr std::size_t kRowsAtOnce = 256;
// A part too fine to be searched completely gets the best point of so many.
constexpr int kMostProbes = 2'000;
// A part of which nothing visible is found in so many probes counts as covered.
constexpr int kMostProbesOfNothing = 500;

/// A ring whose sides can be found by height.
class RingIndex {
 public:
  explicit RingIndex(std::span<const Point> ring) : ring_(ring) {
    const Box box = box_of(ring);
    top_ = box.min_y;
    bottom_ = box.max_y;
    by_height_.sort(ring.size(), top_, bottom_, [&](std::uint32_t i) {
      return SidesByHeight::between(ring_[i], ring_[next(i)]);
    });
  }

  /// Whether a ray from the point to the west crosses the ring an odd number of times.
  bool holds(double x, double y) const {
    if (y < top_ || y > bottom_) return false;
    bool is_inside = false;
    for (const std::uint32_t i : by_height_.at(y)) {
      const Point a = ring_[i];
      const Point b = ring_[next(i)];
      if ((a.y > y) == (b.y > y)) continue;
      const double share = (y - a.y) / (static_cast<double>(b.y) - a.y);
      if (a.x + share * (static_cast<double>(b.x) - a.x) < x) is_inside = !is_inside;
    }
    return is_inside;
  }

 private:
  std::size_t next(std::size_t i) const { return i + 1 == ring_.size() ? 0 : i + 1; }

  std::span<const Point> ring_;
  double top_ = 0;
  double bottom_ = 0;
  SidesByHeight by_height_;
};

/// Rings do not cross but may touch: the middle of a side decides, where a shared vertex would not.
bool lies_in(std::span<const Point> inner, const RingIndex& outer) {
  const Point a = inner[0];
  const Point b = inner[1 % inner.size()];
  return outer.holds((static_cast<double>(a.x) + b.x) / 2, (static_cast<double>(a.y) + b.y) / 2);
}

/// An outer ring and the holes in it, by number.
struct Part {
  std::size_t outer = 0;
  std::vector<std::size_t> holes;
  double area = 0;
};

/// The parts of rings that are nested by even-odd.
std::vector<Part> parts_of(const Rings& rings) {
  struct Ring {
    std::size_t number = 0;
    Box box;
    double area = 0;
    bool is_hole = false;
    std::size_t part = 0;
    std::optional<RingIndex> index = {};  // built when first needed
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
  std::vector<std::size_t> open;  // rings that extend east beyond the beginning of the current one
  for (std::size_t i = 0; i < from_west.size(); ++i) {
    Ring& ring = from_west[i];
    const Ring* around = nullptr;  // the smallest one
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

/// The area in which the deepest point of a part is searched: its bounding box, or a little more.
struct SearchArea {
  double left = 0;  // drawn narrower, as the sides of a Boundary
  double top = 0;
  double middle_x = 0;  // of the bounding box
  double middle_y = 0;
  double side = 0;  // of the squares into which it is divided at first
  int columns = 0;
  int rows = 0;

  /// Elongated boxes are divided into as many squares as fit.
  explicit SearchArea(const Box& box)
      : left(box.min_x / LabelAnchors::kSqueeze), top(static_cast<double>(box.min_y)) {
    const double width = box.max_x / LabelAnchors::kSqueeze - left;
    const double height = box.max_y - top;
    middle_x = left + width / 2;
    middle_y = top + height / 2;
    side = std::max({std::min(width, height), std::max(width, height) / 32, 1.0});
    columns = static_cast<int>(std::ceil(width / side));
    rows = static_cast<int>(std::ceil(height / side));
  }

  double right() const { return left + columns * side; }
  double bottom() const { return top + rows * side; }
};

/// Sides of boundaries, drawn narrower. Small rings count less: a label may cover a pond, and need
/// not keep the same distance from it as from the border of its country.
class Boundary {
 public:
  void clear() {
    sides_.clear();
    beside_.clear();
    is_small_.clear();
  }
  /// Starts a polygon. The inside is within the first polygon, by even-odd, and within none of the
  /// others.
  void begin_polygon(bool is_small) { is_small_.push_back(is_small ? 1 : 0); }
  void add(std::span<const Point> ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point a = ring[i];
      const Point b = ring[i + 1 == ring.size() ? 0 : i + 1];
      if (a != b) sides_.push_back(side_between(a, b));
    }
  }
  /// Adds the sides of a feature that matter within an area. Beyond the area, the border of the
  /// part that is searched is nearer to its points than any side; those to the west only decide
  /// what is inside.
  void add(const CoveringFeature& feature, const SearchArea& area) {
    const auto is_beyond = [](double low, double high, double p, double q) {
      return std::max(p, q) < low || std::min(p, q) > high;
    };
    feature.visit_sides(area.top, area.bottom(), [&](Point a, Point b) {
      if (a == b || is_beyond(area.top, area.bottom(), a.y, b.y)) return;
      const Side side = side_between(a, b);
      const double other_x = side.x + side.dx;
      if (!is_beyond(area.left, area.right(), side.x, other_x)) {
        sides_.push_back(side);
      } else if (side.x < area.left) {
        beside_.push_back(side);
      }
    });
  }
  /// Must be called once everything has been added.
  void sort(const SearchArea& area) {
    size_ = sides_.size();
    sides_.insert(sides_.end(), beside_.begin(), beside_.end());
    by_height_.sort(sides_.size(), area.top, area.bottom(), [this](std::uint32_t i) {
      const Side& side = sides_[i];
      return SidesByHeight::Heights{std::min(side.y, side.y + side.dy),
                                    std::max(side.y, side.y + side.dy)};
    });
  }

  /// The number of sides that may be nearest to a place in the area.
  std::size_t size() const { return size_; }

  /// The point of a side nearest to a place.
  struct Foot {
    double square = 0;  // of the distance between them
    double along = 0;   // from 0 to 1: from the beginning of the side
    double from_x = 0;  // the vector from there to the place
    double from_y = 0;

    double distance() const { return std::sqrt(square); }
  };
  Foot foot(std::uint32_t number, double x, double y) const {
    const Side& side = sides_[number];
    const double px = x - side.x;
    const double py = y - side.y;
    const double along = std::clamp((px * side.dx + py * side.dy) * side.by_square, 0.0, 1.0);
    const double from_x = px - along * side.dx;
    const double from_y = py - along * side.dy;
    return {from_x * from_x + from_y * from_y, along, from_x, from_y};
  }
  /// By how much the foot of a place at a distance of `near` from one with that foot may lie beyond
  /// an end of the side, if the side were longer; none if the foot is an end itself.
  std::optional<double> most_beyond(std::uint32_t number, const Foot& foot, double near) const {
    if (foot.along <= 0 || foot.along >= 1) return std::nullopt;
    const double to_end = std::min(foot.along, 1 - foot.along);
    return std::max(0.0, near - to_end / std::sqrt(sides_[number].by_square));
  }

  bool is_small(std::uint32_t number) const { return is_small_[sides_[number].polygon] != 0; }

  /// Whether the place is inside with respect to the large rings, and to the small ones.
  struct Inside {
    bool of_large = false;
    bool of_small = false;
  };
  Inside inside(double x, double y) {
    is_odd_.assign(is_small_.size(), 0);
    for (const std::uint32_t i : by_height_.at(y)) {
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

  Side side_between(Point a, Point b) const {
    Side side{a.x / LabelAnchors::kSqueeze,
              static_cast<double>(a.y),
              (static_cast<double>(b.x) - a.x) / LabelAnchors::kSqueeze,
              static_cast<double>(b.y) - a.y,
              0,
              static_cast<std::uint32_t>(is_small_.size() - 1)};
    side.by_square = 1 / (side.dx * side.dx + side.dy * side.dy);
    return side;
  }

  std::vector<Side> sides_;
  std::vector<Side> beside_;  // west of the area; added to the others when these are sorted
  std::size_t size_ = 0;
  std::vector<std::uint8_t> is_small_;  // by polygon
  SidesByHeight by_height_;
  std::vector<std::uint8_t> is_odd_;  // by polygon
};

/// A square in which the deepest point may lie.
struct Square {
  double x = 0;
  double y = 0;
  double half = 0;
  double to_large = 0;  // distance of its centre from the nearest large ring, negative outside
  double to_small = 0;  // the same for small rings
  double most = 0;      // upper bound of the depth of its points
  std::size_t first_side = 0;  // index of the first side that may be nearest to a place in it
  std::size_t side_count = 0;

  double half_diagonal() const { return half * std::sqrt(2.0); }
  double depth() const { return std::min(to_large, LabelAnchors::kSmallRings * to_small); }
};

/// Examines squares, one after another.
class Prober {
 public:
  void begin(Boundary& boundary) {
    boundary_ = &boundary;
    sides_.resize(boundary.size());
    for (std::size_t i = 0; i < sides_.size(); ++i) sides_[i] = static_cast<std::uint32_t>(i);
  }

  /// The number of all sides, for squares that are not part of another one.
  std::size_t side_count() const { return boundary_->size(); }

  /// The square with its depth and the sides that may be nearest somewhere in it: those whose
  /// distance from the centre exceeds the smallest one by no more than a diagonal.
  Square look(double x, double y, double half, std::size_t first_side, std::size_t side_count) {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    Square square{x, y, half, kFar, kFar, 0, sides_.size(), 0};
    feet_.clear();
    double large = kFar;
    double small = kFar;
    for (std::size_t i = first_side; i < first_side + side_count; ++i) {
      feet_.push_back(boundary_->foot(sides_[i], x, y));
      double& nearest = boundary_->is_small(sides_[i]) ? small : large;
      nearest = std::min(nearest, feet_.back().square);
    }
    square.to_large = std::sqrt(large);
    square.to_small = std::sqrt(small);
    const double diagonal = 2 * square.half_diagonal();
    const auto squared_reach = [diagonal](double nearest) {
      return (nearest + diagonal) * (nearest + diagonal);
    };
    const double reach_of_large = squared_reach(square.to_large);
    const double reach_of_small = squared_reach(square.to_small);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < side_count; ++i) {
      const std::uint32_t side = sides_[first_side + i];
      if (feet_[i].square > (boundary_->is_small(side) ? reach_of_small : reach_of_large)) continue;
      sides_.push_back(side);
      feet_[kept++] = feet_[i];
    }
    square.side_count = kept;
    const Boundary::Inside inside = boundary_->inside(x, y);
    const double between = inside.of_large ? most_between_walls(square) : kFar;
    if (!inside.of_large) square.to_large = -square.to_large;
    if (!inside.of_small) square.to_small = -square.to_small;
    square.most =
        std::min({square.to_large + square.half_diagonal(), between,
                  LabelAnchors::kSmallRings * (square.to_small + square.half_diagonal())});
    return square;
  }

 private:
  /// An upper bound of the depth of the points of the square, between the nearest large side and
  /// any other. As a point moves by v, its distances d and e from two straight walls change by the
  /// components of v along their normals m and n, and the smaller distance is at most the mean of
  /// both, (d + e + (m + n) v) / 2. So where walls face each other, it is at most half of the
  /// distance between them, wherever the point is. Beyond the end of a side, a point is farther
  /// away than from its straight line, by at most the length by which it is beyond; and behind a
  /// side, no farther than the square extends.
  double most_between_walls(const Square& square) const {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    const double near = square.half_diagonal();
    const auto most_beyond = [&](std::size_t i) {
      const std::uint32_t side = sides_[square.first_side + i];
      if (boundary_->is_small(side)) return std::optional<double>();
      return boundary_->most_beyond(side, feet_[i], near);
    };
    std::size_t nearest = square.side_count;
    for (std::size_t i = 0; i < square.side_count; ++i) {
      const bool is_nearer =
          nearest == square.side_count || feet_[i].square < feet_[nearest].square;
      if (is_nearer && most_beyond(i)) nearest = i;
    }
    if (nearest == square.side_count || feet_[nearest].square == 0) return kFar;
    const Boundary::Foot& one = feet_[nearest];
    const double d = one.distance();
    const double beyond_one = *most_beyond(nearest);
    double most = kFar;
    for (std::size_t i = 0; i < square.side_count; ++i) {
      const Boundary::Foot& other = feet_[i];
      if (one.from_x * other.from_x + one.from_y * other.from_y >= 0) continue;
      const std::optional<double> beyond_other = most_beyond(i);
      if (!beyond_other) continue;
      const double e = other.distance();
      const double x = one.from_x / d + other.from_x / e;
      const double y = one.from_y / d + other.from_y / e;
      const double before_both =
          (d + e + std::sqrt(x * x + y * y) * near + beyond_one + *beyond_other) / 2;
      const double behind_one = near - d + beyond_one;
      const double behind_other = near - e + *beyond_other;
      most = std::min(most, std::max({before_both, behind_one, behind_other}));
    }
    return most;
  }

  Boundary* boundary_ = nullptr;
  std::vector<std::uint32_t> sides_;  // all sides, then those of each square
  std::vector<Boundary::Foot> feet_;  // of the current sides
};

/// Finds the deepest point by subdividing squares in which it may lie. Its coordinates are not
/// rounded yet.
Square deepest(Boundary& boundary, const SearchArea& area, Prober& prober) {
  prober.begin(boundary);
  const std::size_t all = prober.side_count();
  constexpr double kRounding = 1e-3;  // cells: deeper by less is as deep
  std::vector<Square> open;           // a heap
  const auto is_worse = [](const Square& a, const Square& b) { return a.most < b.most; };
  Square best;
  best.to_large = -std::numeric_limits<double>::infinity();
  int probes = 0;
  const auto take = [&](const Square& square) {
    ++probes;
    if (square.depth() > best.depth() + kRounding) best = square;
    open.push_back(square);
    std::ranges::push_heap(open, is_worse);
  };
  // Where many points are equally deep, as in boxes, the middle is the first of them.
  take(prober.look(area.middle_x, area.middle_y, 0, 0, all));
  for (int column = 0; column < area.columns; ++column) {
    for (int row = 0; row < area.rows; ++row) {
      take(prober.look(area.left + (column + 0.5) * area.side, area.top + (row + 0.5) * area.side,
                       area.side / 2, 0, all));
    }
  }
  const auto has_been_searched = [&] {
    return probes >= (best.depth() > 0 ? kMostProbes : kMostProbesOfNothing);
  };
  while (!open.empty() && !has_been_searched()) {
    std::ranges::pop_heap(open, is_worse);
    const Square square = open.back();
    open.pop_back();
    const double wanted = best.depth() + std::max(best.depth() * LabelAnchors::kDepthShare, 0.5);
    if (square.most <= wanted) break;
    const double quarter = square.half / 2;
    for (const double x : {square.x - quarter, square.x + quarter}) {
      for (const double y : {square.y - quarter, square.y + quarter}) {
        take(prober.look(x, y, quarter, square.first_side, square.side_count));
      }
    }
  }
  return best;
}

/// Reused from feature to feature for its memory.
class Finder {
 public:
  /// Takes a feature of a layer and those over it. Returns false if nothing of it exists.
  bool take(const Layer& layer, std::uint32_t row, CoveringFeatures& covering) {
    rings_.clear();
    above_.clear();
    if (layer.is_removed(row)) return false;
    layer.append_outline(row, rings_);
    if (rings_.empty()) return false;
    for (const FeatureOverlap& overlap : layer.overlaps().of(row)) {
      if (overlap.other < row || layer.is_removed(overlap.other)) continue;
      above_.push_back(covering.at(overlap.other));
    }
    return true;
  }
  void take(const Rings& rings, std::span<const Rings> above) {
    rings_ = rings;
    above_.clear();
    for (const Rings& other : above) {
      above_.push_back(std::make_shared<const CoveringFeature>(other));
    }
  }

  /// Digest of everything that the anchors of the feature depend on.
  Digest digest() const {
    std::vector<Digest> digests{digest_of(rings_)};
    for (const auto& above : above_) digests.push_back(above->digest());
    return digest_of(digests);
  }

  void find(std::uint32_t row, LabelParts parts, std::vector<LabelAnchor>& anchors) {
    for (const Part& part : parts_of(rings_)) {
      const Box box = box_of(rings_[part.outer]);
      const SearchArea area(box);
      const double small = part.area * LabelAnchors::kSmallShare;
      boundary_.clear();
      boundary_.begin_polygon(false);
      boundary_.add(rings_[part.outer]);
      const auto add_holes = [&](bool are_small) {
        for (const std::size_t hole : part.holes) {
          if ((area_of_ring(rings_[hole]) < small) == are_small) boundary_.add(rings_[hole]);
        }
      };
      add_holes(false);
      boundary_.begin_polygon(true);
      add_holes(true);
      for (const auto& above : above_) {
        if (!above->box().intersects(box)) continue;
        boundary_.begin_polygon(above->area() < small);
        boundary_.add(*above, area);
      }
      boundary_.sort(area);
      const Square found = deepest(boundary_, area, prober_);
      // Rounded to whole cells.
      const double x = std::round(found.x * LabelAnchors::kSqueeze);
      const double y = std::round(found.y);
      const double moved = std::hypot(x / LabelAnchors::kSqueeze - found.x, y - found.y);
      const double depth =
          std::min(found.to_large - moved, LabelAnchors::kSmallRings * (found.to_small - moved));
      if (depth <= 0) continue;
      // Where rings touch themselves, lobes may cancel out, and holes exceed what is left.
      const double size = std::max(part.area, 0.0);
      anchors.push_back({row,
                         {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)},
                         static_cast<float>(depth),
                         static_cast<float>(size)});
      if (parts == LabelParts::largest) return;
    }
  }

 private:
  Rings rings_;
  Boundary boundary_;
  Prober prober_;
  std::vector<std::shared_ptr<const CoveringFeature>> above_;
};

/// Calls visit(row, finder, results) for all existing features, after the finder has taken the
/// feature. Returns what the calls append to `results`, in order of rows.
template <typename Result, typename Visit>
std::vector<Result> for_each_feature(const Layer& layer, unsigned threads, const Visit& visit) {
  const std::size_t rows = layer.features().size();
  std::vector<std::vector<Result>> results((rows + kRowsAtOnce - 1) / kRowsAtOnce);
  CoveringFeatures covering(layer);
  for_each_in_parallel(results.size(), threads, [&](std::size_t i) {
    Finder finder;
    const std::size_t end = std::min((i + 1) * kRowsAtOnce, rows);
    for (auto row = static_cast<std::uint32_t>(i * kRowsAtOnce); row < end; ++row) {
      if (finder.take(layer, row, covering)) visit(row, finder, results[i]);
    }
  });
  std::size_t count = 0;
  for (const auto& some : results) count += some.size();
  std::vector<Result> all;
  all.reserve(count);
  for (const auto& some : results) all.insert(all.end(), some.begin(), some.end());
  return all;
}

/// Earlier results, by the digest of what they were computed from.
class AnchorsByDigest {
 public:
  AnchorsByDigest(const KnownAnchors& known, unsigned threads) {
    if (known.of_all_parts.empty()) return;
    entries_ = for_each_feature<Entry>(
        *known.layer, threads,
        [&](std::uint32_t row, const Finder& finder, std::vector<Entry>& entries) {
          const auto first =
              std::ranges::lower_bound(known.of_all_parts, row, {}, &LabelAnchor::row);
          const auto end =
              std::find_if(first, known.of_all_parts.end(),
                           [row](const LabelAnchor& anchor) { return anchor.row != row; });
          entries.push_back({finder.digest(), {first, end}});
        });
    std::ranges::sort(entries_, {}, &Entry::digest);
  }

  /// None if the feature was not examined before.
  std::optional<std::span<const LabelAnchor>> find(const Finder& finder) const {
    if (entries_.empty()) return std::nullopt;
    const Digest digest = finder.digest();
    const auto entry = std::ranges::lower_bound(entries_, digest, {}, &Entry::digest);
    if (entry == entries_.end() || entry->digest != digest) return std::nullopt;
    return entry->anchors;
  }

 private:
  struct Entry {
    Digest digest;
    std::span<const LabelAnchor> anchors;
  };

  std::vector<Entry> entries_;
};

}  // namespace

LabelAnchors::LabelAnchors(const Layer& layer, LabelParts parts, unsigned threads)
    : anchors_(for_each_feature<LabelAnchor>(
          layer, threads,
          [parts](std::uint32_t row, Finder& finder, std::vector<LabelAnchor>& anchors) {
            finder.find(row, parts, anchors);
          })) {}

LabelAnchors::LabelAnchors(const Layer& layer, const KnownAnchors& known, unsigned threads) {
  const AnchorsByDigest before(known, threads);
  anchors_ = for_each_feature<LabelAnchor>(
      layer, threads,
      [&before](std::uint32_t row, Finder& finder, std::vector<LabelAnchor>& anchors) {
        const auto found = before.find(finder);
        if (!found) return finder.find(row, LabelParts::all, anchors);
        for (LabelAnchor anchor : *found) {
          anchor.row = row;
          anchors.push_back(anchor);
        }
      });
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
  finder.take(rings, above);
  std::vector<LabelAnchor> anchors;
  finder.find(row, parts, anchors);
  return anchors;
}

}  // namespace trapeze
