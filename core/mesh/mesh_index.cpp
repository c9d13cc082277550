#include "core/mesh/mesh_index.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/grid/for_each_in_parallel.h"
#include "core/grid/hilbert.h"

namespace trapeze {
namespace {

struct Interval {
  double min;
  double max;
};

/// The range of x of the edge between y0 and y1.
Interval x_range(const MeshView& mesh, const MeshEdge& edge, std::int32_t y0, std::int32_t y1) {
  const Point a = mesh.vertices[edge.upper];
  const Point b = mesh.vertices[edge.lower];
  if (a.y == b.y)
    return {static_cast<double>(std::min(a.x, b.x)), static_cast<double>(std::max(a.x, b.x))};
  const double slope = (static_cast<double>(b.x) - a.x) / (static_cast<double>(b.y) - a.y);
  const double x0 = a.x + slope * (static_cast<double>(y0) - a.y);
  const double x1 = a.x + slope * (static_cast<double>(y1) - a.y);
  return {std::min(x0, x1), std::max(x0, x1)};
}

/// Whether, all the way from y0 to y1, the left side is west of the box and the right side east of
/// it.
bool spans(const MeshView& mesh, const MeshTrapezoid& trapezoid, const Box& box, std::int32_t y0,
           std::int32_t y1) {
  const Interval left = x_range(mesh, mesh.edges[trapezoid.left], y0, y1);
  const Interval right = x_range(mesh, mesh.edges[trapezoid.right], y0, y1);
  return left.max + 1 <= box.min_x && right.min - 1 >= box.max_x;
}

/// One class per octave of levels; level 0 and kNeverDies have classes of their own.
unsigned lifespan_class(Level level) {
  return (level + kLevelsPerOctave - 1u) / kLevelsPerOctave;
}

/// Where the levels of a tree over `count` items begin, and where the last one ends. The last level
/// has one entry, or the first has none.
std::vector<std::size_t> heights_over(std::size_t count, std::size_t fanout) {
  std::vector<std::size_t> begins = {0};
  std::size_t entries = count;
  do {
    entries = (entries + fanout - 1) / fanout;
    begins.push_back(begins.back() + entries);
  } while (entries > 1);
  return begins;
}

}  // namespace

Box box_of(const MeshView& mesh, const MeshTrapezoid& trapezoid) {
  const std::int32_t y0 = mesh.vertices[trapezoid.top].y;
  const std::int32_t y1 = mesh.vertices[trapezoid.bottom].y;
  const Interval left = x_range(mesh, mesh.edges[trapezoid.left], y0, y1);
  const Interval right = x_range(mesh, mesh.edges[trapezoid.right], y0, y1);
  const auto clamped = [](double x) {
    return static_cast<std::int32_t>(std::clamp(x, double{kGridMin}, double{kGridMax}));
  };
  return {clamped(std::floor(std::min(left.min, right.min))), y0,
          clamped(std::ceil(std::max(left.max, right.max))), y1};
}

bool meets(const MeshView& mesh, const MeshTrapezoid& trapezoid, const Box& box) {
  const double top = std::max(mesh.vertices[trapezoid.top].y, box.min_y);
  const double bottom = std::min(mesh.vertices[trapezoid.bottom].y, box.max_y);
  if (top > bottom || mesh.vertices[trapezoid.top].y == mesh.vertices[trapezoid.bottom].y) {
    return false;
  }
  // The span of heights at which a line is to the west, or to the east, of an x.
  double from = top;
  double to = bottom;
  const auto narrow = [&](double x_top, double x_bottom, double x, bool is_west_wanted) {
    const double at_top = is_west_wanted ? x - x_top : x_top - x;  // >= 0 on the wanted side
    const double at_bottom = is_west_wanted ? x - x_bottom : x_bottom - x;
    if (at_top >= 0 && at_bottom >= 0) return;
    const double crossing = top + (bottom - top) * (at_top / (at_top - at_bottom));
    if (at_top < 0) from = at_bottom < 0 ? to + 1 : std::max(from, crossing);
    if (at_bottom < 0 && at_top >= 0) to = std::min(to, crossing);
  };
  const EdgeLine left(mesh, trapezoid.left);
  const EdgeLine right(mesh, trapezoid.right);
  narrow(left.x_at(top), left.x_at(bottom), box.max_x, true);
  narrow(right.x_at(top), right.x_at(bottom), box.min_x, false);
  return from <= to;
}

bool cover_box(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const Box& box) {
  // A tile within a large polygon intersects a few trapezoids; with more than this, it contains a
  // boundary.
  constexpr std::size_t kMaxTrapezoids = 48;
  struct Rows {
    std::int32_t begin;
    std::int32_t end;
  };
  std::array<Rows, kMaxTrapezoids> spanned;
  std::size_t count = 0;
  for (const TrapezoidRange& range : ranges) {
    if (count + range.count > kMaxTrapezoids) return false;
    for (const MeshTrapezoid& trapezoid : mesh.trapezoids.subspan(range.first, range.count)) {
      const std::int32_t y0 = std::max(mesh.vertices[trapezoid.top].y, box.min_y);
      const std::int32_t y1 = std::min(mesh.vertices[trapezoid.bottom].y, box.max_y);
      if (y0 < y1 && spans(mesh, trapezoid, box, y0, y1)) spanned[count++] = {y0, y1};
    }
  }
  std::sort(spanned.begin(), spanned.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Rows& a, const Rows& b) { return a.begin < b.begin; });
  std::int32_t covered_to = box.min_y;
  for (std::size_t i = 0; i < count && spanned[i].begin <= covered_to; ++i) {
    covered_to = std::max(covered_to, spanned[i].end);
  }
  return count > 0 && covered_to >= box.max_y;
}

std::uint64_t order_key(const Box& box, Lifespan lifespan) {
  const Point centre{static_cast<std::int32_t>((std::int64_t{box.min_x} + box.max_x) / 2),
                     static_cast<std::int32_t>((std::int64_t{box.min_y} + box.max_y) / 2)};
  return (std::uint64_t{lifespan_class(lifespan.dies)} << 32) | hilbert(centre);
}

MeshIndex::MeshIndex(const MeshView& mesh, TrapezoidRange range,
                     std::span<const Lifespan> lifespans, unsigned threads)
    : range_(range), heights_(heights_over(range.count, kFanout)) {
  constexpr std::size_t kTrapezoidsAtOnce = std::size_t{1} << 14;
  static_assert(kTrapezoidsAtOnce % kFanout == 0);
  std::vector<Entry> entries(heights_.back());
  const std::size_t pieces = (range.count + kTrapezoidsAtOnce - 1) / kTrapezoidsAtOnce;
  for_each_in_parallel(pieces, threads, [&](std::size_t piece) {
    const std::size_t end = std::min<std::size_t>(range.count, (piece + 1) * kTrapezoidsAtOnce);
    for (std::size_t i = piece * kTrapezoidsAtOnce; i < end; ++i) {
      Entry& entry = entries[i / kFanout];
      const std::size_t t = range.first + i;
      entry.box.include(box_of(mesh, mesh.trapezoids[t]));
      entry.min_born = std::min(entry.min_born, lifespans[t].born);
      entry.max_dies = std::max(entry.max_dies, lifespans[t].dies);
    }
  });
  for (std::size_t height = 1; height + 1 < heights_.size(); ++height) {
    const std::size_t below = heights_[height - 1];
    for (std::size_t i = below; i < heights_[height]; ++i) {
      Entry& entry = entries[heights_[height] + (i - below) / kFanout];
      entry.box.include(entries[i].box);
      entry.min_born = std::min(entry.min_born, entries[i].min_born);
      entry.max_dies = std::max(entry.max_dies, entries[i].max_dies);
    }
  }
  entries_ = std::move(entries);
}

MeshIndex::MeshIndex(TrapezoidRange range, std::span<const Entry> entries)
    : range_(range),
      entries_(StoredArray<Entry>::looking_at(entries)),
      heights_(heights_over(range.count, kFanout)) {
  if (entries.size() != heights_.back()) {
    throw std::invalid_argument(
        "the number of entries of an index does not fit that of its trapezoids");
  }
}

void MeshIndex::select(const Box& box, Level born, Level alive, std::span<const Lifespan> lifespans,
                       std::vector<TrapezoidRange>& ranges) const {
  if (range_.count == 0) return;
  const Wanted wanted{box, born, alive};
  const std::size_t root = heights_.size() - 2;
  if (wanted.meets(entries_[heights_[root]])) {
    descend(root, 0, Query{wanted, lifespans, ranges});
  }
}

std::span<const MeshIndex::Entry> MeshIndex::children(std::size_t height, std::size_t index) const {
  const std::size_t first = heights_[height - 1] + index * kFanout;
  const std::size_t end = std::min(first + kFanout, heights_[height]);
  return {&entries_[first], end - first};
}

void MeshIndex::descend(std::size_t height, std::size_t index, const Query& query) const {
  const std::size_t begin = index * kFanout;
  if (height > 0) {
    const std::span<const Entry> below = children(height, index);
    for (std::size_t i = 0; i < below.size(); ++i) {
      if (query.wanted.meets(below[i])) descend(height - 1, begin + i, query);
    }
    return;
  }
  const std::size_t end = std::min<std::size_t>(begin + kFanout, range_.count);
  for (std::size_t i = range_.first + begin; i < range_.first + end; ++i) {
    const Lifespan life = query.lifespans[i];
    if (life.born > query.wanted.born || life.dies <= query.wanted.alive) continue;
    const auto id = static_cast<std::uint32_t>(i);
    if (!query.ranges.empty() && query.ranges.back().first + query.ranges.back().count == id) {
      ++query.ranges.back().count;
    } else {
      query.ranges.push_back({id, 1});
    }
  }
}

std::uint64_t MeshIndex::estimate(const Box& box, Level born, Level alive) const {
  constexpr std::uint64_t kFound = 5;  // of the eight in a block; 4 to 6 on maps of all kinds
  if (range_.count == 0) return 0;
  const Wanted wanted{box, born, alive};
  const std::size_t root = heights_.size() - 2;
  if (!wanted.meets(entries_[heights_[root]])) return 0;
  return kFound * (root == 0 ? 1 : count_blocks(root, 0, wanted));
}

std::uint64_t MeshIndex::count_blocks(std::size_t height, std::size_t index,
                                      const Wanted& wanted) const {
  const std::span<const Entry> below = children(height, index);
  std::uint64_t blocks = 0;
  if (height == 1) {
    for (const Entry& entry : below) blocks += wanted.meets(entry);
    return blocks;
  }
  for (std::size_t i = 0; i < below.size(); ++i) {
    if (wanted.meets(below[i])) blocks += count_blocks(height - 1, index * kFanout + i, wanted);
  }
  return blocks;
}

}  // namespace trapeze
