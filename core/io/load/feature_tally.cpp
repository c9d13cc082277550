#include "core/io/load/feature_tally.h"

#include <algorithm>
#include <utility>

namespace trapeze {

void FeatureTally::skip(const FeatureKey& feature, std::string reason) {
  ++skipped;
  skips.push_back({feature.order, {feature.id, std::move(reason)}});
}

void FeatureTally::remark(const FeatureKey& feature, std::string words) {
  remarks.push_back({feature.order, {feature.id, std::move(words)}});
  if (remarks.size() < 2 * kMaxRemarks) return;
  sort_by_order(remarks);
  remarks.resize(kMaxRemarks);
}

void sort_by_order(std::vector<OrderedNote>& notes) {
  std::stable_sort(notes.begin(), notes.end(),
                   [](const OrderedNote& a, const OrderedNote& b) { return a.order < b.order; });
}

}  // namespace trapeze
