// The distribution of numbers, as needed for classes and histograms.
//
// Thread-safety: any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/layer/layer.h"

namespace trapeze {

struct ValueSpread {
  std::vector<double> values;         // ascending, distinct and finite
  std::vector<std::uint32_t> counts;  // how often each of them occurs
  std::size_t count = 0;              // of all numbers, duplicates included
  std::size_t missing = 0;            // places without a number

  bool is_empty() const { return values.empty(); }
  double least() const { return values.front(); }
  double greatest() const { return values.back(); }
  /// In bytes.
  std::size_t memory() const;
};

/// Numbers that are not finite count as missing.
ValueSpread spread_of(std::vector<double> numbers, std::size_t missing);

/// Collects single values; values that are not numbers count as missing.
class SpreadCollector {
 public:
  void add(const Value& value);
  ValueSpread take() { return spread_of(std::move(numbers_), missing_); }

 private:
  std::vector<double> numbers_;
  std::size_t missing_ = 0;
};

/// The distribution of a numeric attribute over all features of the layer.
ValueSpread spread_of(const Layer& layer, int field);

/// The count of numbers in each of `bins` >= 1 intervals of equal width from the least to the
/// greatest number.
std::vector<std::size_t> histogram(const ValueSpread& spread, std::size_t bins);

}  // namespace trapeze
