// Outcomes of the features of a source, counted separately by each thread and added up at the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/io/load/load_report.h"

namespace trapeze {

/// A feature of a source.
struct FeatureKey {
  std::size_t order = 0;  // index among the features of the source
  std::uint32_t row = 0;  // index among its polygon features, in the same order
  std::int64_t id = 0;
};

/// A note with the position of its feature, for sorting into the order of the source.
struct OrderedNote {
  std::size_t order = 0;
  FeatureNote note;
};

/// Sums that do not depend on how features were distributed over threads.
struct FeatureTally {
  std::size_t loaded = 0;
  std::size_t other_geometry = 0;
  std::size_t empty = 0;
  std::size_t skipped = 0;
  std::size_t polygons = 0;
  std::size_t rings = 0;
  std::size_t source_vertices = 0;
  std::size_t vertices = 0;
  std::size_t collapsed_rings = 0;
  std::size_t repaired = 0;
  CoverageCounts coverage;
  std::vector<OrderedNote> skips;
  // On features that were not skipped: the first kMaxRemarks in the order of the source, and
  // possibly some more.
  std::vector<OrderedNote> remarks;

  static constexpr std::size_t kMaxRemarks = 100;

  void skip(const FeatureKey& feature, std::string reason);
  void remark(const FeatureKey& feature, std::string words);
};

void sort_by_order(std::vector<OrderedNote>& notes);

}  // namespace trapeze
