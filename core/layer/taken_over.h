// What a layer takes over from an earlier one: which features, and where their trapezoids and
// grains belong among newly built ones. Private to LayerBuilder.
#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/radix_sort.h"
#include "core/layer/earlier_layer.h"

namespace trapeze {

/// A feature that is taken over.
struct TakenRow {
  std::uint32_t earlier = 0;  // its row in the earlier layer
  std::uint32_t row = 0;      // its present row
  std::uint32_t first = 0;    // the first present row of its graph
};

/// The place of an item in an array that is in order of keys, then of graphs; items of one graph
/// keep their order.
struct OrderPlace {
  std::uint64_t key = 0;
  std::uint32_t graph = 0;  // its first row

  friend constexpr auto operator<=>(const OrderPlace&, const OrderPlace&) = default;
};

/// Immutable. Any number of threads may read.
class TakenOver {
 public:
  static constexpr std::uint32_t kNotTaken = 0xffffffff;

  /// Takes over nothing.
  TakenOver() = default;
  /// `rows` are those of whole units. `earlier` must outlive this object.
  TakenOver(const EarlierLayer& earlier, std::vector<TakenRow> rows);

  bool empty() const { return rows_.empty(); }
  /// In order of present rows.
  std::span<const TakenRow> rows() const { return rows_; }
  /// Whether any two rows are still in their earlier order.
  bool keeps_order() const { return std::ranges::is_sorted(rows_, {}, &TakenRow::earlier); }
  /// Precondition: not empty.
  const EarlierLayer& earlier() const { return *earlier_; }
  /// The present row of a row of the earlier layer; kNotTaken if it is not taken over.
  std::uint32_t row_now(std::uint32_t earlier_row) const { return row_now_[earlier_row]; }

  /// Merges items of the earlier layer and new ones into the order in which they would be if all
  /// were new. The earlier items are those in `range` (the second bound is excluded), which are in
  /// order there; key_of(i) is the key of item i, and row_of(i) the earlier row of its feature.
  /// `fresh` are the places of the new ones, in order. Calls take(begin, end) for earlier items,
  /// among which the caller must leave out those that are not taken over, and take_fresh(k). Sorts
  /// on up to `threads` threads if features have changed places; makes the calls from one thread.
  template <typename KeyOf, typename RowOf, typename Take, typename TakeFresh>
  void merge(std::pair<std::size_t, std::size_t> range, const KeyOf& key_of, const RowOf& row_of,
             std::span<const OrderPlace> fresh, const Take& take, const TakeFresh& take_fresh,
             unsigned threads) const;

 private:
  template <typename KeyOf, typename RowOf>
  std::vector<std::uint32_t> in_order_now(std::pair<std::size_t, std::size_t> range,
                                          const KeyOf& key_of, const RowOf& row_of,
                                          unsigned threads) const;

  const EarlierLayer* earlier_ = nullptr;
  std::vector<TakenRow> rows_;
  std::vector<std::uint32_t> row_now_;  // by earlier row
  // By earlier row: the first present row of its graph. For rows that are not taken over, that of
  // the last preceding graph that is.
  std::vector<std::uint32_t> graph_now_;
  bool is_in_order_ = true;  // graphs are in their earlier order
};

template <typename KeyOf, typename RowOf>
std::vector<std::uint32_t> TakenOver::in_order_now(std::pair<std::size_t, std::size_t> range,
                                                   const KeyOf& key_of, const RowOf& row_of,
                                                   unsigned threads) const {
  // By graph first, then by key.
  std::vector<std::uint32_t> ends(rows_.back().row + std::size_t{2}, 0);
  const auto for_each_taken = [&](const auto& visit) {
    for (std::size_t i = range.first; i < range.second; ++i) {
      const std::uint32_t row = row_of(i);
      if (row_now_[row] != kNotTaken) visit(static_cast<std::uint32_t>(i), graph_now_[row]);
    }
  };
  std::vector<std::uint32_t> graphs;  // read once, because it changes if a file is truncated
  for_each_taken([&](std::uint32_t, std::uint32_t graph) {
    ++ends[graph + 1];
    graphs.push_back(graph);
  });
  for (std::size_t g = 1; g < ends.size(); ++g) ends[g] += ends[g - 1];
  std::vector<std::uint32_t> by_graph(graphs.size());
  std::size_t k = 0;
  for_each_taken([&](std::uint32_t i, std::uint32_t) {
    if (k < graphs.size()) by_graph[ends[graphs[k++]]++] = i;
  });
  LargeArray<KeyedIndex> keys(by_graph.size());
  LargeArray<KeyedIndex> scratch;
  for (std::size_t i = 0; i < by_graph.size(); ++i) {
    keys[i] = {key_of(by_graph[i]), static_cast<std::uint32_t>(i)};
  }
  sort_by_key(keys, scratch, threads);
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const KeyedIndex& item : keys) order.push_back(by_graph[item.index]);
  return order;
}

template <typename KeyOf, typename RowOf, typename Take, typename TakeFresh>
void TakenOver::merge(std::pair<std::size_t, std::size_t> range, const KeyOf& key_of,
                      const RowOf& row_of, std::span<const OrderPlace> fresh, const Take& take,
                      const TakeFresh& take_fresh, unsigned threads) const {
  std::vector<std::uint32_t> order;
  if (!is_in_order_) order = in_order_now(range, key_of, row_of, threads);
  const std::size_t count = is_in_order_ ? range.second - range.first : order.size();
  const auto item = [&](std::size_t i) { return is_in_order_ ? range.first + i : order[i]; };
  const auto is_before = [&](std::size_t i, const OrderPlace& place) {
    return OrderPlace{key_of(item(i)), graph_now_[row_of(item(i))]} < place;
  };
  const auto take_up_to = [&](std::size_t begin, std::size_t end) {
    if (is_in_order_ && begin < end) return take(range.first + begin, range.first + end);
    for (std::size_t i = begin; i < end; ++i) take(order[i], order[i] + std::size_t{1});
  };
  std::size_t done = 0;
  for (std::size_t k = 0; k < fresh.size(); ++k) {
    // In steps that double: the next one is near if much is new.
    std::size_t step = 1;
    std::size_t low = done;
    while (low + step <= count && is_before(low + step - 1, fresh[k])) {
      low += step;
      step *= 2;
    }
    std::size_t high = std::min(low + step - 1, count);
    while (low < high) {
      const std::size_t middle = low + (high - low) / 2;
      if (is_before(middle, fresh[k])) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    take_up_to(done, low);
    done = low;
    take_fresh(k);
  }
  take_up_to(done, count);
}

}  // namespace trapeze
