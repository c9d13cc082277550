#include "server/values/value_spread.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace trapeze {

std::size_t ValueSpread::memory() const {
  return sizeof *this + values.capacity() * sizeof(double) +
         counts.capacity() * sizeof(std::uint32_t);
}

ValueSpread spread_of(std::vector<double> numbers, std::size_t missing) {
  ValueSpread spread;
  const std::size_t all = numbers.size() + missing;
  std::erase_if(numbers, [](double number) { return !std::isfinite(number); });
  std::ranges::sort(numbers);
  spread.count = numbers.size();
  spread.missing = all - numbers.size();
  for (const double number : numbers) {
    if (spread.values.empty() || spread.values.back() != number) {
      spread.values.push_back(number);
      spread.counts.push_back(0);
    }
    ++spread.counts.back();
  }
  spread.values.shrink_to_fit();
  spread.counts.shrink_to_fit();
  return spread;
}

void SpreadCollector::add(const Value& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    numbers_.push_back(static_cast<double>(*integer));
  } else if (const auto* real = std::get_if<double>(&value)) {
    numbers_.push_back(*real);
  } else {
    ++missing_;
  }
}

ValueSpread spread_of(const Layer& layer, int field) {
  SpreadCollector collector;
  const FeatureTable& features = layer.features();
  for (std::uint32_t row = 0; row < features.size(); ++row) {
    if (layer.is_removed(row)) continue;
    collector.add(features.value(row, field));
  }
  return collector.take();
}

std::vector<std::size_t> histogram(const ValueSpread& spread, std::size_t bins) {
  std::vector<std::size_t> counts(bins, 0);
  if (spread.is_empty()) return counts;
  // Halved, so that the width does not overflow for any doubles.
  const double half_width = spread.greatest() / 2 - spread.least() / 2;
  for (std::size_t i = 0; i < spread.values.size(); ++i) {
    const double share =
        half_width > 0 ? (spread.values[i] / 2 - spread.least() / 2) / half_width : 0;
    const auto bin = static_cast<std::size_t>(share * static_cast<double>(bins));
    counts[std::min(bin, bins - 1)] += spread.counts[i];
  }
  return counts;
}

}  // namespace trapeze
