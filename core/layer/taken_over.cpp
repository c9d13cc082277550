#include "core/layer/taken_over.h"

#include <tuple>

namespace trapeze {

TakenOver::TakenOver(const EarlierLayer& earlier, std::vector<TakenRow> rows)
    : earlier_(&earlier), rows_(std::move(rows)) {
  std::ranges::sort(rows_, {}, &TakenRow::row);
  const std::span<const std::uint32_t> first_rows = earlier.first_rows();
  row_now_.assign(first_rows.size(), kNotTaken);
  std::vector<std::uint32_t> first_now(first_rows.size(), kNotTaken);  // by earlier first row
  std::uint32_t last = 0;
  for (const TakenRow& taken : rows_) {
    row_now_[taken.earlier] = taken.row;
    if (taken.first != taken.row) continue;
    const std::uint32_t first = first_rows[taken.earlier];
    first_now[first] = taken.first;
    is_in_order_ = is_in_order_ && first >= last;
    last = first;
  }
  graph_now_.resize(first_rows.size());
  std::uint32_t before = 0;
  for (std::uint32_t row = 0; row < first_rows.size(); ++row) {
    if (first_rows[row] != row) {
      graph_now_[row] = graph_now_[first_rows[row]];
      continue;
    }
    if (first_now[row] != kNotTaken) before = first_now[row];
    graph_now_[row] = before;
  }
}

}  // namespace trapeze
