#include "core/io/load/feature_builder.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <utility>

#include "core/borders/gap_closing.h"
#include "core/grid/for_each_in_parallel.h"
#include "core/sweep/clean_rings.h"

namespace trapeze {
namespace {

std::string percent_text(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", 100 * share);
  return text;
}

}  // namespace

void BuildTally::skip(std::size_t order, std::int64_t id, std::string reason) {
  ++skipped;
  skips.push_back({order, {id, std::move(reason)}});
}

void BuildTally::remark(std::size_t order, std::int64_t id, std::string words) {
  if (remarks.size() < kMaxRemarks) remarks.push_back({order, {id, std::move(words)}});
}

void FeatureBuilder::build(const FeatureJob& job) {
  FeatureRings& feature = reader_.read(*job.geometry, job.layer_index);
  tally_.polygons += feature.polygons;
  tally_.rings += feature.source_rings;
  tally_.source_vertices += feature.vertices;
  if (!feature.failure.empty()) {
    tally_.skip(job.order, job.id, feature.failure);
  } else if (feature.rings.empty()) {
    ++tally_.empty;
  } else if (generalization_.coverage != CoverageMode::off) {
    wait(job, feature.rings);
  } else {
    count({job.order, job.id}, builder_.add(job.row, feature.rings));
  }
}

void FeatureBuilder::wait(const FeatureJob& job, Rings& rings) {
  tally_.collapsed_rings += clean_rings(rings);
  if (rings.empty()) {
    ++tally_.empty;
  } else {
    waiting_.push_back({job.order, job.row, job.id, rings});
  }
}

void FeatureBuilder::build_apart(WaitingFeature& feature) {
  count({feature.order, feature.id}, builder_.add(feature.row, feature.rings));
  feature.rings = Rings();
}

void FeatureBuilder::build_together(std::span<WaitingFeature* const> features) {
  std::vector<std::uint32_t> rows;
  std::vector<const Rings*> rings;
  for (const WaitingFeature* feature : features) {
    rows.push_back(feature->row);
    rings.push_back(&feature->rings);
  }
  const Assembly assembly = builder_.add_coverage(rows, rings);
  tally_.coverage.apart += assembly.apart.size();
  for (const std::uint32_t i : assembly.apart) build_apart(*features[i]);
  if (!assembly.together.empty()) count(features, assembly);
}

void FeatureBuilder::close_gaps(std::span<WaitingFeature> features) {
  std::vector<Rings*> rings;
  for (WaitingFeature& feature : features) rings.push_back(&feature.rings);
  const GapClosing done = trapeze::close_gaps(rings, generalization_.close_gaps);
  tally_.coverage.snapped += done.moved + done.led;
}

void FeatureBuilder::count(std::span<WaitingFeature* const> features, const Assembly& assembly) {
  for (const std::uint32_t i : assembly.together) features[i]->rings = Rings();
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
    const WaitingFeature& lower = *features[overlap.lower];
    const double share = overlap.area / outcome.areas[overlap.lower];
    tally_.remark(lower.order, lower.id,
                  percent_text(share) + " of it lies under feature " +
                      std::to_string(features[overlap.upper]->id));
  }
}

void FeatureBuilder::count(const Subject& subject, const BuildOutcome& outcome) {
  tally_.collapsed_rings += outcome.collapsed_rings;
  if (!outcome.failure.empty()) {
    tally_.skip(subject.order, subject.id, outcome.failure);
    return;
  }
  if (!outcome.built) {
    ++tally_.empty;
    return;
  }
  ++tally_.loaded;
  tally_.vertices += outcome.vertices;
  if (!outcome.noded) return;
  ++tally_.repaired;
  tally_.remark(subject.order, subject.id, "repaired: its rings cross or touch");
}

void build_waiting(std::vector<FeatureBuilder>& builders, const LayerOptions& options) {
  std::vector<WaitingFeature> waiting;
  for (FeatureBuilder& builder : builders) {
    for (WaitingFeature& feature : builder.take_waiting()) waiting.push_back(std::move(feature));
  }
  std::sort(waiting.begin(), waiting.end(),
            [](const auto& a, const auto& b) { return a.row < b.row; });
  if (options.close_gaps > 0) builders.front().close_gaps(waiting);
  std::vector<const Rings*> rings;
  for (const WaitingFeature& feature : waiting) rings.push_back(&feature.rings);
  std::vector<std::vector<WaitingFeature*>> tasks;
  std::vector<bool> is_grouped(waiting.size(), false);
  for (const auto& group : group_features(rings, options.coverage)) {
    auto& task = tasks.emplace_back();
    for (const std::uint32_t i : group) {
      task.push_back(&waiting[i]);
      is_grouped[i] = true;
    }
  }
  // Those that take long come first, so that no thread is left alone with one.
  std::stable_sort(tasks.begin(), tasks.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    if (!is_grouped[i]) tasks.push_back({&waiting[i]});
  }
  std::atomic<std::size_t> next = 0;
  for_each_in_parallel(builders.size(), builders.size(), [&](std::size_t thread) {
    for (std::size_t i = next++; i < tasks.size(); i = next++) {
      if (tasks[i].size() == 1) {
        builders[thread].build_apart(*tasks[i].front());
      } else {
        builders[thread].build_together(tasks[i]);
      }
    }
  });
}

}  // namespace trapeze
