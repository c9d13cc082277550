// How a layer is built.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/adapt/generalization_options.h"
#include "core/borders/coverage_options.h"

namespace trapeze {

/// Greatest distance, in pixels, over which polygons become one block.
constexpr double kWidestMerge = 64;

/// How each graph is generalized, and which features live in one.
struct LayerOptions : GeneralizationOptions {
  CoverageMode coverage = kUsualCoverage;
  double close_gaps = 0;  // metres on the ground, up to kWidestGap; where there are coverages
  /// What lies nearer to each other becomes one block (see merging.h): pixels, where the tolerance
  /// is the usual quarter of one, up to kWidestMerge; 0: nothing does. Where there are coverages.
  double merge = 0;
  /// Only features with the same value of that attribute become one block; empty: all may.
  std::string merge_by = {};

  /// What it means for features of these classes; empty: all are of one.
  Merging merging(std::span<const std::uint64_t> classes = {}) const {
    return {merge / kUsualTolerance, numbered(classes)};
  }

  friend bool operator==(const LayerOptions&, const LayerOptions&) = default;

 private:
  static constexpr double kUsualTolerance = 0.25;  // pixels
};

}  // namespace trapeze
