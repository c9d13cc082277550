#include "core/layer/overlaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "core/grid/for_each_in_parallel.h"
#include "core/grid/grid.h"
#include "core/mesh/mesh_index.h"

namespace trapeze {
namespace {

constexpr double kNarrowest = 2;  // cells
constexpr double kAlong = FeatureOverlap::kAlong;
constexpr std::size_t kMostPairsOf = 16;                   // per trapezoid
constexpr std::size_t kLeastPairs = std::size_t{1} << 20;  // 12 MB
constexpr std::uint64_t kMostStepsOf = 1024;               // per trapezoid
constexpr int kMostHalvings = 64;
constexpr std::size_t kRowsAtOnce = 1024;
constexpr std::uint64_t kLeastSteps = std::uint64_t{1} << 24;

/// The intersection of two boxes; empty if they only touch.
Box common_part(const Box& a, const Box& b) {
  const Box part{std::max(a.min_x, b.min_x), std::max(a.min_y, b.min_y), std::min(a.max_x, b.max_x),
                 std::min(a.max_y, b.max_y)};
  return part.min_x < part.max_x && part.min_y < part.max_y ? part : Box();
}

/// A trapezoid at full detail.
struct Item {
  Box box;
  std::uint32_t trapezoid = 0;
  std::int32_t reach = 0;  // the greatest max_y of its feature's items up to this one
};

/// What two trapezoids, or two features, share.
struct Common {
  double area = 0;
  double min_x = std::numeric_limits<double>::infinity();
  double max_x = -min_x;
  double min_y = min_x;
  double max_y = -min_x;
  double along = 0;  // length along which their boundaries coincide

  void add(const Common& more) {
    area += more.area;
    along += more.along;
    min_x = std::min(min_x, more.min_x);
    max_x = std::max(max_x, more.max_x);
    min_y = std::min(min_y, more.min_y);
    max_y = std::max(max_y, more.max_y);
  }
  double width() const { return area > 0 ? area / std::hypot(max_x - min_x, max_y - min_y) : 0; }
};

class OverlapSearch {
 public:
  OverlapSearch(const OverlapInput& input, unsigned threads)
      : input_(input), threads_(threads), is_compared_(input.kinds.size()) {
    const auto untouched =
        static_cast<std::uint64_t>(std::ranges::count(input.lifespans, Level{0}, &Lifespan::born));
    most_steps_ = kLeastSteps + kMostStepsOf * untouched;
    most_pairs_ = kLeastPairs + kMostPairsOf * untouched;
  }

  /// So many pairs are known already; they count towards the most that there may be.
  FeatureOverlaps run(std::size_t known) {
    std::vector<std::uint32_t> rows;
    Box all;
    for (std::uint32_t row = 0; row < input_.boxes.size(); ++row) {
      if (input_.boxes[row].is_empty()) continue;
      rows.push_back(row);
      all.include(input_.boxes[row]);
    }
    if (!rows.empty()) {
      join(rows, all, kMostHalvings);
      collect_items();
      is_looking_ahead_ = false;
      steps_ = 0;
      join(rows, all, kMostHalvings);
    }
    found_.is_complete = !is_over() && found_.pairs.size() + known < most_pairs_;
    std::ranges::sort(found_.pairs, {}, [](const FeatureOverlap& overlap) {
      return std::pair(overlap.row, overlap.other);
    });
    return std::move(found_);
  }

 private:
  std::span<const Item> items_of(std::uint32_t row) const {
    return std::span(items_).subspan(begins_[row], begins_[row + 1] - begins_[row]);
  }
  bool are_of_one_kind(std::span<const std::uint32_t> rows) const {
    return std::ranges::all_of(
        rows, [&](std::uint32_t row) { return input_.kinds[row] == input_.kinds[rows.front()]; });
  }
  bool is_over() const { return steps_ > most_steps_ || found_.pairs.size() >= most_pairs_; }

  void collect_items();
  void order_items(std::uint32_t row);
  void join(std::span<const std::uint32_t> rows, const Box& region, int halvings);
  void join_each(std::span<const std::uint32_t> rows, const Box& region);
  void compare(std::uint32_t a, std::uint32_t b, const Box& place);
  void take_items(std::uint32_t row, const Box& place, std::vector<const Item*>& items);
  template <typename Visit>
  static std::size_t scan(const Item& item, const std::vector<const Item*>& others,
                          std::size_t from, const Visit& visit);
  Common common(const Item& a, const Item& b) const;

  const OverlapInput& input_;
  const unsigned threads_;
  std::vector<Item> items_;                // by row, and by top
  std::vector<std::size_t> begins_;        // by row; and the end
  std::vector<std::uint8_t> is_compared_;  // by row
  bool is_looking_ahead_ = true;           // the first pass only determines which features have to
                                           // be compared
  FeatureOverlaps found_;
  std::uint64_t steps_ = 0;
  std::uint64_t most_steps_ = 0;
  std::size_t most_pairs_ = 0;
  std::vector<const Item*> some_;
  std::vector<const Item*> others_;
};

/// Only for features that have to be compared, which are few on most maps.
void OverlapSearch::collect_items() {
  struct Owned {
    Item item;
    std::uint32_t row = 0;
  };
  const std::size_t pieces = (input_.feature_of.size() + kItemsAtOnce - 1) / kItemsAtOnce;
  std::vector<std::vector<Owned>> found(pieces);
  for_each_in_parallel(pieces, threads_, [&](std::size_t piece) {
    const std::size_t end = std::min(input_.feature_of.size(), (piece + 1) * kItemsAtOnce);
    for (std::size_t i = piece * kItemsAtOnce; i < end; ++i) {
      const std::uint32_t row = input_.feature_of[i];
      if (input_.lifespans[i].born != 0 || is_compared_[row] == 0) continue;
      const MeshTrapezoid& t = input_.mesh.trapezoids[i];
      if (input_.mesh.vertices[t.top].y >= input_.mesh.vertices[t.bottom].y) continue;
      found[piece].push_back({{box_of(input_.mesh, t), static_cast<std::uint32_t>(i), 0}, row});
    }
  });
  const std::size_t rows = input_.kinds.size();
  begins_.assign(rows + 1, 0);
  for (const auto& piece : found) {
    for (const Owned& owned : piece) ++begins_[owned.row + 1];
  }
  for (std::size_t row = 0; row < rows; ++row) begins_[row + 1] += begins_[row];
  items_.resize(begins_.back());
  std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
  for (auto& piece : found) {
    for (const Owned& owned : piece) items_[next[owned.row]++] = owned.item;
    piece = {};
  }
  const std::size_t blocks = (rows + kRowsAtOnce - 1) / kRowsAtOnce;
  for_each_in_parallel(blocks, threads_, [&](std::size_t block) {
    const std::size_t end = std::min(rows, (block + 1) * kRowsAtOnce);
    for (std::size_t row = block * kRowsAtOnce; row < end; ++row) {
      order_items(static_cast<std::uint32_t>(row));
    }
  });
}

void OverlapSearch::order_items(std::uint32_t row) {
  const std::span<Item> items = std::span(items_).subspan(begins_[row], items_of(row).size());
  std::ranges::sort(items, {}, [](const Item& item) {
    const Box& box = item.box;
    return std::tuple(box.min_y, box.min_x, box.max_y, box.max_x);
  });
  std::int32_t reach = kGridMin;
  for (Item& item : items) item.reach = reach = std::max(reach, item.box.max_y);
}

/// Halves the region, at most so many times, until few features are left in each part.
void OverlapSearch::join(std::span<const std::uint32_t> rows, const Box& region, int halvings) {
  constexpr std::size_t kFew = 16;
  const std::int64_t width = std::int64_t{region.max_x} - region.min_x;
  const std::int64_t height = std::int64_t{region.max_y} - region.min_y;
  steps_ += rows.size();
  if (is_over() || are_of_one_kind(rows)) return;
  const bool is_small = rows.size() <= kFew || std::max(width, height) < 2;
  if (is_small || halvings == 0) return join_each(rows, region);

  const bool is_wide = width >= height;
  const auto middle_of = [&](std::uint32_t row) {
    const Box box = common_part(input_.boxes[row], region);
    const std::int64_t sum =
        is_wide ? std::int64_t{box.min_x} + box.max_x : std::int64_t{box.min_y} + box.max_y;
    return static_cast<std::int32_t>(sum / 2);
  };
  std::vector<std::int32_t> middles;
  for (const std::uint32_t row : rows) middles.push_back(middle_of(row));
  const auto middle = middles.begin() + static_cast<std::ptrdiff_t>(middles.size() / 2);
  std::ranges::nth_element(middles, middle);
  Box before = region;
  Box after = region;
  (is_wide ? before.max_x : before.max_y) = (is_wide ? after.min_x : after.min_y) =
      std::clamp(*middle, (is_wide ? region.min_x : region.min_y) + 1,
                 (is_wide ? region.max_x : region.max_y) - 1);
  std::vector<std::uint32_t> some;
  std::vector<std::uint32_t> others;
  for (const std::uint32_t row : rows) {
    if (!common_part(input_.boxes[row], before).is_empty()) some.push_back(row);
    if (!common_part(input_.boxes[row], after).is_empty()) others.push_back(row);
  }
  // If the features are as large as the region, its parts contain no fewer of them.
  if (some.size() + others.size() > rows.size() * 7 / 4) return join_each(rows, region);
  join(some, before, halvings - 1);
  join(others, after, halvings - 1);
}

/// The common part of two features is examined in the region that contains its north-western
/// corner.
void OverlapSearch::join_each(std::span<const std::uint32_t> rows, const Box& region) {
  for (std::size_t i = 0; i < rows.size() && !is_over(); ++i) {
    steps_ += rows.size() - i;
    for (std::size_t k = i + 1; k < rows.size(); ++k) {
      const auto [a, b] = std::minmax(rows[i], rows[k]);
      if (input_.kinds[a] == input_.kinds[b]) continue;
      const Box place = common_part(input_.boxes[a], input_.boxes[b]);
      const bool begins_here = !place.is_empty() && place.min_x >= region.min_x &&
                               place.min_x < region.max_x && place.min_y >= region.min_y &&
                               place.min_y < region.max_y;
      if (!begins_here) continue;
      if (is_looking_ahead_) {
        is_compared_[a] = is_compared_[b] = 1;
      } else {
        compare(a, b, place);
      }
    }
  }
}

/// Items that intersect the place, in order of their tops.
void OverlapSearch::take_items(std::uint32_t row, const Box& place,
                               std::vector<const Item*>& items) {
  items.clear();
  const std::span<const Item> all = items_of(row);
  auto item = std::ranges::upper_bound(all, place.min_y, {}, &Item::reach);
  const auto first = item;
  for (; item != all.end() && item->box.min_y < place.max_y; ++item) {
    if (!common_part(item->box, place).is_empty()) items.push_back(&*item);
  }
  steps_ += static_cast<std::uint64_t>(item - first);
}

void OverlapSearch::compare(std::uint32_t a, std::uint32_t b, const Box& place) {
  take_items(a, place, some_);
  if (some_.empty()) return;
  take_items(b, place, others_);
  Common all;
  double width = 0;
  const auto add = [&](const Item& item, const Item& other) {
    const Common both = common(item, other);
    if (both.area <= 0) return;
    all.add(both);
    width = std::max(width, both.width());
  };
  // Each pair is found where the later of the two begins.
  std::size_t i = 0;
  std::size_t k = 0;
  while (i < some_.size() && k < others_.size()) {
    if (some_[i]->box.min_y <= others_[k]->box.min_y) {
      steps_ += scan(*some_[i++], others_, k, add);
    } else {
      steps_ += scan(*others_[k++], some_, i, add);
    }
  }
  width = std::max(width, all.width());
  if (width <= kNarrowest) return;
  const auto cells = static_cast<std::uint32_t>(width);
  const auto along = static_cast<std::uint32_t>(std::min(all.along, 4e9));
  found_.pairs.push_back({a, b, cells, along});
  found_.pairs.push_back({b, a, cells, along});
}

/// Visits those of the others, from there on, that the item's box intersects; returns how many were
/// examined.
template <typename Visit>
std::size_t OverlapSearch::scan(const Item& item, const std::vector<const Item*>& others,
                                std::size_t from, const Visit& visit) {
  std::size_t i = from;
  for (; i < others.size() && others[i]->box.min_y < item.box.max_y; ++i) {
    if (!common_part(item.box, others[i]->box).is_empty()) visit(item, *others[i]);
  }
  return i - from + 1;
}

/// Computed from the common widths at a few heights.
Common OverlapSearch::common(const Item& a, const Item& b) const {
  constexpr int kHeights = 5;
  const int top = std::max(a.box.min_y, b.box.min_y);
  const int bottom = std::min(a.box.max_y, b.box.max_y);
  const MeshTrapezoid& s = input_.mesh.trapezoids[a.trapezoid];
  const MeshTrapezoid& t = input_.mesh.trapezoids[b.trapezoid];
  const EdgeLine s_left(input_.mesh, s.left);
  const EdgeLine s_right(input_.mesh, s.right);
  const EdgeLine t_left(input_.mesh, t.left);
  const EdgeLine t_right(input_.mesh, t.right);
  const double height = static_cast<double>(bottom) - top;
  const double step = height / (kHeights - 1);
  std::array<double, kHeights> from;
  std::array<double, kHeights> to;
  for (int i = 0; i < kHeights; ++i) {
    const double y = top + i * step;
    from[i] = std::max(s_left.x_at(y), t_left.x_at(y));
    to[i] = std::min(s_right.x_at(y), t_right.x_at(y));
  }
  Common common;
  const auto add_sides = [&](const EdgeLine& side, const EdgeLine& other) {
    const bool are_near = std::abs(side.x_at(top) - other.x_at(top)) <= kAlong &&
                          std::abs(side.x_at(bottom) - other.x_at(bottom)) <= kAlong;
    if (are_near) common.along += std::hypot(height, side.x_at(bottom) - side.x_at(top));
  };
  add_sides(s_left, t_left);
  add_sides(s_right, t_right);
  // Horizontal sides; or both have a vertex at that height beside them.
  const auto add_level = [&](int y, int other_y, int at) {
    const double apart = std::abs(static_cast<double>(y) - other_y);
    if (apart <= kAlong) common.along += std::max(0.0, to[at] - from[at]);
  };
  add_level(a.box.min_y, b.box.min_y, 0);
  add_level(a.box.max_y, b.box.max_y, kHeights - 1);
  for (int i = 0; i < kHeights; ++i) {
    if (from[i] >= to[i]) continue;
    const bool is_end = i == 0 || i == kHeights - 1;
    common.add({(to[i] - from[i]) * step * (is_end ? 0.5 : 1), from[i], to[i], top + i * step,
                top + i * step});
    // The overlap may extend as far as the adjacent heights.
    for (const int k : {std::max(i - 1, 0), std::min(i + 1, kHeights - 1)}) {
      common.add(
          {0, std::min(from[k], to[k]), std::max(from[k], to[k]), top + k * step, top + k * step});
    }
  }
  return common;
}

}  // namespace

OverlapTable::OverlapTable(StoredArray<FeatureOverlap> pairs, std::size_t rows)
    : pairs_(std::move(pairs)) {
  if (pairs_.empty()) return;
  const bool are_in_order = std::ranges::is_sorted(pairs_, {}, &FeatureOverlap::row);
  const bool are_rows = std::ranges::all_of(
      pairs_, [rows](const FeatureOverlap& pair) { return pair.row < rows && pair.other < rows; });
  if (!are_in_order || !are_rows) throw std::invalid_argument("overlaps are not in order of rows");
  begins_.assign(rows + 1, 0);
  for (const FeatureOverlap& pair : pairs_) ++begins_[pair.row + 1];
  for (std::size_t row = 0; row < rows; ++row) begins_[row + 1] += begins_[row];
  for (const FeatureOverlap& pair : pairs_) {
    if (pair.is_in_common()) {
      in_common_.resize(rows);
      in_common_[pair.row] = 1;
    }
    if (pair.along == 0) continue;
    runs_along_.resize(rows);
    runs_along_[pair.row] = 1;
    ++pairs_along_;
  }
}

FeatureOverlaps find_overlaps(const OverlapInput& input, std::vector<FeatureOverlap> known,
                              unsigned threads) {
  const auto compared = static_cast<std::size_t>(std::ranges::count_if(
      known, [](const FeatureOverlap& pair) { return !pair.is_in_common(); }));
  FeatureOverlaps found = OverlapSearch(input, threads).run(compared);
  if (known.empty()) return found;
  const auto by_rows = [](const FeatureOverlap& pair) { return std::pair(pair.row, pair.other); };
  found.pairs.insert(found.pairs.end(), known.begin(), known.end());
  std::ranges::sort(found.pairs, {}, by_rows);
  const auto are_of_the_same = [&](const FeatureOverlap& one, const FeatureOverlap& other) {
    return by_rows(one) == by_rows(other);
  };
  found.pairs.erase(std::unique(found.pairs.begin(), found.pairs.end(), are_of_the_same),
                    found.pairs.end());
  return found;
}

}  // namespace trapeze
