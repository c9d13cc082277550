// How a layer is built.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/adapt/generalization_options.h"
#include "core/borders/coverage_options.h"

namespace trapeze {

/// Greatest distance, in pixels, over which polygons merge into one block.
constexpr double kWidestMerge = 64;

/// How each graph is generalized, and which features share one.
struct LayerOptions : GeneralizationOptions {
  CoverageMode coverage = kUsualCoverage;
  double close_gaps = 0;  // metres on the ground, up to kWidestGap; applies to coverages
  /// Polygons nearer to each other than this become one block (see merging.h). In pixels, for the
  /// usual tolerance of a quarter of a pixel; up to kWidestMerge; 0: no merging. Applies to
  /// coverages.
  double merge = 0;
  /// Only features with the same value of that attribute become one block; empty: all may.
  std::string merge_by = {};

  /// The merging options for features of these classes; empty: all are of one class.
  Merging merging(std::span<const std::uint64_t> classes = {}) const {
    return {merge / kUsualTolerance, numbered(classes)};
  }

  friend bool operator==(const LayerOptions&, const LayerOptions&) = default;

 private:
  static constexpr double kUsualTolerance = 0.25;  // pixels
};

}  // namespace trapeze
