// The contents of one builder of a layer: the histories of its features and coverages, one after
// another. Private to LayerBuilder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/adapt/history.h"
#include "core/grid/digest.h"
#include "core/grid/rings.h"
#include "core/layer/built_units.h"
#include "core/layer/overlaps.h"
#include "core/layer/taken_over.h"

namespace trapeze {

struct Stock {
  struct Part {
    std::uint32_t row;     // the first one of a coverage
    std::size_t vertices;  // where its arrays begin
    std::size_t edges;
    std::size_t milestones;
    std::size_t trapezoids;
    std::size_t horizontal_edges;
    std::size_t grains;
  };
  struct Outline {
    std::uint32_t row;
    std::size_t begin;  // rings
    std::size_t end;
  };
  /// A feature that is taken over and whose rings occur more than once.
  struct Double {
    Digest digest;
    TakenRow row;
  };
  std::vector<Part> parts;
  History history;
  std::vector<Outline> outlines;
  Rings outline_rings;
  std::vector<FeatureOverlap> shared;  // pairs of features that share a face of a coverage
  std::vector<TakenRow> taken;         // from an earlier layer
  std::vector<Double> doubles;         // also from an earlier layer
  BuiltUnits units;                    // of all, built or taken over
};

}  // namespace trapeze
