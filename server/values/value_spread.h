// How numbers lie, whatever they belong to: what classes and histograms are made of.
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
  std::vector<double> values;         // ascending, each once; all are finite
  std::vector<std::uint32_t> counts;  // how often each of them occurs
  std::size_t count = 0;              // of numbers in all
  std::size_t missing = 0;            // where there might have been one

  bool is_empty() const { return values.empty(); }
  double least() const { return values.front(); }
  double greatest() const { return values.back(); }
  /// In bytes.
  std::size_t memory() const;
};

/// What is not finite counts as missing.
ValueSpread spread_of(std::vector<double> numbers, std::size_t missing);

/// Takes values one after the other; what is no number counts as missing.
class SpreadCollector {
 public:
  void add(const Value& value);
  ValueSpread take() { return spread_of(std::move(numbers_), missing_); }

 private:
  std::vector<double> numbers_;
  std::size_t missing_ = 0;
};

/// The same of an attribute of numbers, of all features of the layer.
ValueSpread spread_of(const Layer& layer, int field);

/// How many numbers lie in each of `bins` >= 1 parts of equal width from the least to the greatest.
std::vector<std::size_t> histogram(const ValueSpread& spread, std::size_t bins);

}  // namespace trapeze
