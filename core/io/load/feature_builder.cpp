#include "core/io/load/feature_builder.h"

#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "core/grid/web_mercator.h"

namespace trapeze {
namespace {

std::string percent_text(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", 100 * share);
  return text;
}

// Formats a length in cells in metres at the equator.
std::string metres_text(double cells) {
  const double metres = cells / cells_from_ground(1, 0);
  char text[32];
  std::snprintf(text, sizeof text, metres < 10 ? "%.2g m" : "%.0f m", metres);
  return text;
}

}  // namespace

void FeatureBuilder::build_apart(const FeatureKey& feature, Rings& rings, unsigned threads) {
  const BuildOutcome outcome = builder_.add(feature.row, rings, threads);
  tally_.collapsed_rings += outcome.collapsed_rings;
  if (!outcome.failure.empty()) return tally_.skip(feature, outcome.failure);
  if (!outcome.built) {
    ++tally_.empty;
    return;
  }
  ++tally_.loaded;
  tally_.vertices += outcome.vertices;
  remark_on_detail(feature);
  if (!outcome.noded) return;
  ++tally_.repaired;
  tally_.remark(feature, "repaired: its rings cross or touch");
}

void FeatureBuilder::remark_on_detail(const FeatureKey& feature) {
  const std::optional<double> tolerance = builder_.most_tolerance();
  if (!tolerance) return;
  tally_.remark(feature, "drawn in more detail than asked: beyond a tolerance of " +
                             metres_text(*tolerance) +
                             " it is not simplified, as thousands of its edges lie side by side");
}

void FeatureBuilder::build_together(std::span<WaitingFeature* const> features, unsigned threads) {
  std::vector<std::uint32_t> rows;
  std::vector<const Rings*> rings;
  for (const WaitingFeature* feature : features) {
    rows.push_back(feature->key.row);
    rings.push_back(&feature->rings);
  }
  const Assembly assembly = builder_.add_coverage(rows, rings, threads, classes_of(features));
  tally_.coverage.apart += assembly.apart.size();
  if (!assembly.together.empty()) remark_on_detail(features[assembly.together.front()]->key);
  if (!assembly.outcome.failure.empty()) {
    tally_.remark(features.front()->key, "built apart from " + std::to_string(features.size() - 1) +
                                             " neighbours: " + assembly.outcome.failure);
  } else if (assembly.outcome.is_crowded) {
    tally_.remark(features.front()->key,
                  "of it and " + std::to_string(features.size() - 1) + " neighbours, " +
                      std::to_string(assembly.apart.size()) +
                      " that overlap are built separately: too many overlap each other");
  }
  for (const std::uint32_t i : assembly.apart) {
    build_apart(features[i]->key, features[i]->rings_apart(), threads);
  }
  if (!assembly.together.empty()) count(features, assembly);
}

void FeatureBuilder::count(std::span<WaitingFeature* const> features, const Assembly& assembly) {
  const CoverageOutcome& outcome = assembly.outcome;
  tally_.loaded += assembly.together.size();
  tally_.vertices += outcome.vertices;
  CoverageCounts& counts = tally_.coverage;
  ++counts.groups;
  counts.features += assembly.together.size();
  counts.noded += outcome.noded;
  counts.shared_edges += outcome.shared_edges;
  counts.junctions += outcome.junctions;
  counts.overlaps += outcome.overlaps.size();
  counts.gaps += outcome.gaps;
  counts.filled += outcome.filled;
  for (const Overlap& overlap : outcome.overlaps) {
    const double share = overlap.area / outcome.areas[overlap.lower];
    tally_.remark(features[overlap.lower]->key,
                  "overlapped: " + percent_text(share) + " of it lies under feature " +
                      std::to_string(features[overlap.upper]->key.id));
  }
}

}  // namespace trapeze
